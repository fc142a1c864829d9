//! What stays the same when settings change.

use super::about::Influence;
use super::table::{ALL, Setting, Settings};
use super::target_error::TargetError;

impl Settings {
    /// The settings that have other values in `other`.
    pub fn differing<'a>(&'a self, other: &'a Self) -> impl Iterator<Item = &'static dyn Setting> + 'a {
        ALL.iter().copied().filter(|setting| !setting.is_same(self, other))
    }

    /// The strongest influence of the settings that have other values in `other`; `None` if all are the same.
    pub fn strongest_difference(&self, other: &Self) -> Option<Influence> {
        ALL.iter().filter_map(|setting| setting.influence(self, other)).min()
    }

    /// Whether these settings ask for the same hemisphere rays as `other`, as long as memory is enough for both.
    pub fn same_rays_as(&self, other: &Self) -> bool {
        self.strongest_difference(other).is_none_or(|influence| influence > Influence::Rays)
    }

    /// Whether bounces computed with `other` are those that these settings ask for, as long as memory is enough for
    /// both. How many there are does not matter.
    pub fn same_bounces_as(&self, other: &Self) -> bool {
        // Errors are those of what is read, and they decide where samples are added.
        let same_errors = self.target_error == TargetError::Off || self.projection == other.projection;
        same_errors && self.strongest_difference(other).is_none_or(|influence| influence > Influence::Bounces)
    }

    /// The settings that give `found` other bounces than these, as a list for a message.
    pub(crate) fn differences_of_bounces(&self, found: &Self) -> String {
        let is_other = |setting: &&dyn Setting| {
            setting.influence(self, found).is_some_and(|influence| influence <= Influence::Storage)
        };
        let differing = ALL.iter().copied().filter(is_other);
        let phrase = |setting: &dyn Setting| {
            let name = setting.about().name.replace('_', " ");
            format!("{name} {}, not {}", setting.text(found), setting.text(self))
        };
        differing.map(phrase).collect::<Vec<_>>().join("; ")
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::settings::{BounceLimit, Memory, Preset, Projection, Tail};

    #[test]
    fn differences_are_told_by_name() {
        let here = Settings { projection: Projection::Point, ..Preset::Medium.settings() };
        let there = Settings {
            seed: 7,
            projection: Projection::Area,
            bounces: BounceLimit::All,
            memory: Memory(1 << 20),
            ..here.clone()
        };
        let text = "projection area, not point; memory 1 MiB, not 2 GiB; seed 7, not 0";
        assert_eq!(here.differences_of_bounces(&there), text);
    }

    #[test]
    fn the_number_of_bounces_does_not_change_what_each_of_them_is() {
        let a = Preset::Medium.settings();
        let more = Settings { bounces: BounceLimit::All, remainder: 0.1, tail: Tail::Geometric, ..a.clone() };
        assert!(a.same_bounces_as(&more) && a.same_bounces_as(&a));
        assert_eq!(a.strongest_difference(&more), Some(Influence::Extent));
        assert!(a.same_bounces_as(&Settings { memory: Memory(1), ..a.clone() }));
        assert!(!a.same_bounces_as(&Settings { seed: 1, ..a.clone() }));
    }

    #[test]
    fn means_and_least_squares_differ_only_in_how_they_are_read() {
        let with = |projection| Settings { projection, ..Preset::Medium.settings() };
        let [point, area, least_squares] =
            [Projection::Point, Projection::Area, Projection::LeastSquares].map(with);
        assert_eq!(area.strongest_difference(&least_squares), Some(Influence::Sum));
        assert!(area.same_bounces_as(&least_squares) && least_squares.same_rays_as(&area));
        assert!(!point.same_rays_as(&area) && !least_squares.same_bounces_as(&point));
        assert_eq!(area.differences_of_bounces(&least_squares), "");
        let to_error = |settings| Settings { target_error: "2%".parse().unwrap(), ..settings };
        assert!(!to_error(area).same_bounces_as(&to_error(least_squares)));
    }

    #[test]
    fn shadow_rays_change_bounces_but_no_hemisphere_ray() {
        let a = Preset::Medium.settings();
        let shadows = Settings { direct_samples: 1, ..a.clone() };
        assert!(a.same_rays_as(&shadows) && !a.same_bounces_as(&shadows));
        assert!(!a.same_rays_as(&Settings { indirect_samples: 1, ..a.clone() }));
    }
}
