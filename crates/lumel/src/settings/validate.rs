//! Which settings can be used.

use super::adaptive::Adaptive;
use super::bounce_limit::BounceLimit;
use super::error::SettingsError;
use super::layers::Layers;
use super::point_spacing::PointSpacing;
use super::solver_kind::SolverKind;
use super::table::{
    ADAPTIVE, ALL, BOUNCES, DIRECTIONAL, Definition, LAYERS, LEVELS, POINT_SPACING, SCHEDULE, SOLVER,
    Setting as _, Settings, SettingsPatch, TARGET_ERROR,
};
use super::target_error::TargetError;
use super::value::Value;
use lumel_basis::Directional;

impl SettingsPatch {
    /// Checks every value that is set.
    ///
    /// # Errors
    /// [`SettingsError::Invalid`] for the first value out of bounds.
    pub fn validate(&self) -> Result<(), SettingsError> {
        ALL.iter().try_for_each(|setting| setting.check(self))
    }
}

impl Settings {
    /// Checks every value, and that all go together.
    ///
    /// # Errors
    /// [`SettingsError::Invalid`] or [`SettingsError::Conflict`] for the first that is wrong.
    pub fn validate(&self) -> Result<(), SettingsError> {
        SettingsPatch::complete(self).validate()?;
        if let (false, BounceLimit::Count(_)) = (self.tells_bounces(), self.bounces) {
            let reason = "shots tell no bounces apart, use bounces all";
            return Err(self.excluded_by(&SCHEDULE, &BOUNCES, reason));
        }
        if self.point_spacing != PointSpacing::Off {
            self.validate_with_points()?;
        }
        if self.levels > 1 {
            self.validate_with_levels()?;
        }
        if self.target_error == TargetError::Off {
            return Ok(());
        }
        if self.solver == SolverKind::Neumann {
            return Err(self.excluded_by(&TARGET_ERROR, &SOLVER, "a target error needs stored rays"));
        }
        if self.layers != Layers::Off {
            let reason = "the error of single layers is not known";
            return Err(self.excluded_by(&TARGET_ERROR, &LAYERS, reason));
        }
        Ok(())
    }

    /// What does not go together with points.
    fn validate_with_points(&self) -> Result<(), SettingsError> {
        if self.adaptive != Adaptive::Off {
            if self.levels < 3 {
                let reason = "the two coarsest levels are measured everywhere, use 3 levels or more";
                return Err(self.excluded_by(&ADAPTIVE, &LEVELS, reason));
            }
            if self.solver == SolverKind::Neumann {
                let reason = "points that follow light store their rays";
                return Err(self.excluded_by(&ADAPTIVE, &SOLVER, reason));
            }
        }
        if self.layers != Layers::Off {
            let reason = "layers would not add up, as all direct light is measured at vertices";
            return Err(self.excluded_by(&POINT_SPACING, &LAYERS, reason));
        }
        if self.directional != Directional::Off {
            let reason = "light by direction is carried on vertices alone";
            return Err(self.excluded_by(&POINT_SPACING, &DIRECTIONAL, reason));
        }
        Ok(())
    }

    /// What does not go together with levels of points.
    fn validate_with_levels(&self) -> Result<(), SettingsError> {
        if self.point_spacing == PointSpacing::Off {
            return Err(self.excluded_by(&LEVELS, &POINT_SPACING, "levels are levels of points"));
        }
        if self.target_error != TargetError::Off {
            let reason = "the error of what levels differ by says little about their sum";
            return Err(self.excluded_by(&LEVELS, &TARGET_ERROR, reason));
        }
        if !self.tells_bounces() {
            let reason = "which points are the brightest is not known of their differences";
            return Err(self.excluded_by(&LEVELS, &SCHEDULE, reason));
        }
        Ok(())
    }

    fn excluded_by<S: Value, T: Value>(
        &self,
        setting: &Definition<S>,
        other: &Definition<T>,
        reason: &'static str,
    ) -> SettingsError {
        SettingsError::Conflict {
            setting: setting.about.name,
            value: setting.text(self),
            other: other.about.name,
            other_value: other.text(self),
            reason,
        }
    }

    /// These settings with values out of bounds replaced by defaults: for what was kept from an earlier version.
    #[must_use]
    pub fn mended(mut self) -> Self {
        let (patch, default) = (SettingsPatch::complete(&self), Self::default());
        for setting in ALL.iter().filter(|setting| setting.check(&patch).is_err()) {
            setting.copy(&default, &mut self);
        }
        if self.validate().is_err() { default } else { self }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::settings::ScheduleKind;

    #[test]
    fn what_makes_no_sense_is_refused_with_its_name_its_value_and_a_remedy() {
        let good = Settings::default();
        assert_eq!(good.validate(), Ok(()));
        let count = "a whole number from 1 to 16777216";
        for (bad, message) in [
            (
                Settings { indirect_samples: 0, ..good.clone() },
                format!("indirect_samples is 0 but must be {count}"),
            ),
            (
                Settings { direct_samples: u32::MAX, ..good.clone() },
                format!("direct_samples is 4294967295 but must be {count}"),
            ),
            (
                Settings { remainder: f32::NAN, ..good.clone() },
                "remainder is NaN but must be a number between 0 and 1".to_owned(),
            ),
            (
                Settings { bounces: BounceLimit::Count(10_001), ..good.clone() },
                "bounces is 10001 but must be a whole number from 0 to 10000, or all".to_owned(),
            ),
        ] {
            let error = bad.validate().unwrap_err();
            assert_eq!(error.to_string(), message);
            assert!(message.ends_with(&error.remedy().replace("it must", "must")), "{}", error.remedy());
            let mended = bad.mended();
            assert_eq!(mended.differing(&good).count(), 0);
        }
    }

    #[test]
    fn a_target_error_needs_a_solver_with_stored_rays() {
        let target_error = "2%".parse().unwrap();
        let settings = Settings { target_error, solver: SolverKind::Neumann, ..Settings::default() };
        let error = settings.validate().unwrap_err();
        let message =
            "target_error 2 % and solver neumann exclude each other: a target error needs stored rays";
        assert_eq!((error.to_string().as_str(), error.setting()), (message, "target_error"));
        assert_eq!(error.remedy(), "change target_error or solver");
        assert_eq!(settings.mended(), Settings::default());
    }

    #[test]
    fn shots_tell_no_bounces_apart_but_a_preset_does_not_ask_for_them() {
        let shoot = SettingsPatch { schedule: Some(ScheduleKind::Shoot), ..SettingsPatch::default() };
        let draft = SettingsPatch { preset: Some(crate::settings::Preset::Draft), ..shoot.clone() };
        for patch in [shoot.clone(), draft] {
            assert_eq!(patch.settings().validate(), Ok(()));
        }
        let three = SettingsPatch { bounces: Some(BounceLimit::Count(3)), ..shoot };
        let error = three.settings().validate().unwrap_err();
        let message =
            "schedule shoot and bounces 3 exclude each other: shots tell no bounces apart, use bounces all";
        assert_eq!(error.to_string(), message);
        assert_eq!(error.remedy(), "change schedule or bounces");
    }

    #[test]
    fn a_target_error_and_layers_exclude_each_other() {
        let layers = Settings { layers: Layers::Lights, ..Settings::default() };
        assert_eq!(layers.validate(), Ok(()));
        let error = Settings { target_error: "2%".parse().unwrap(), ..layers }.validate().unwrap_err();
        let message =
            "target_error 2 % and layers lights exclude each other: the error of single layers is not known";
        assert_eq!(error.to_string(), message);
        assert_eq!(error.remedy(), "change target_error or layers");
    }
}
