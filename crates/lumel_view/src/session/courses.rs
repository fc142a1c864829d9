//! The course of this solve and of the one before, side by side.

use crate::solver::Moment;
use lumel::Settings;
use lumel::setting::{SCHEDULE, Setting as _};

/// How a solve went.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Course {
    /// What it was.
    pub name: String,
    /// After each bounce or shot.
    pub moments: Vec<Moment>,
}

/// How the last two solves went.
#[derive(Clone, Debug, Default)]
pub struct Courses {
    /// The last one, which may still run.
    pub last: Course,
    /// The one before.
    pub before: Course,
    /// What of the last one was there when it was resumed.
    resumed: Vec<Moment>,
}

impl Courses {
    /// Begins another one; or the last one goes on.
    pub(super) fn begin(&mut self, settings: &Settings, rays: Rays, goes_on: GoesOn) {
        self.resumed = Vec::new();
        if goes_on == GoesOn::Yes && !self.last.moments.is_empty() {
            self.resumed.clone_from(&self.last.moments);
            return;
        }
        let label = SCHEDULE.choices().iter().find(|choice| choice.name == SCHEDULE.text(settings));
        let label = label.map_or("", |choice| choice.label);
        let name = match rays {
            Rays::Stored => format!("{label}, rays stored"),
            Rays::New => label.to_owned(),
        };
        let last = std::mem::replace(&mut self.last, Course { name, moments: Vec::new() });
        if !last.moments.is_empty() {
            self.before = last;
        }
    }

    /// Takes in what a job has told.
    pub(super) fn follow(&mut self, told: &[Moment]) {
        let before = self.resumed.last().map_or(0.0, |moment| moment.seconds);
        let later = told.iter().map(|moment| Moment { seconds: before + moment.seconds, ..*moment });
        self.last.moments = self.resumed.iter().copied().chain(later).collect();
    }
}

/// Whether a solve finds its rays stored.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Rays {
    Stored,
    New,
}

/// Whether a solve goes on with what the last one has.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum GoesOn {
    Yes,
    No,
}

#[cfg(test)]
mod tests {
    use super::*;
    use lumel::ScheduleKind;

    fn moment(seconds: f64) -> Moment {
        Moment { seconds, unshot: 0.5, missing: 0.25 }
    }

    fn times(course: &Course) -> Vec<f64> {
        course.moments.iter().map(|moment| moment.seconds).collect()
    }

    #[test]
    fn a_resumed_solve_continues_its_curve_and_another_one_begins_a_new_one() {
        let shoot = Settings { schedule: ScheduleKind::Shoot, ..Settings::default() };
        let mut courses = Courses::default();
        courses.begin(&Settings::default(), Rays::New, GoesOn::No);
        courses.follow(&[moment(1.0), moment(2.0)]);
        courses.begin(&Settings::default(), Rays::Stored, GoesOn::Yes);
        assert_eq!(times(&courses.last), [1.0, 2.0]);
        courses.follow(&[moment(0.5)]);
        assert_eq!(times(&courses.last), [1.0, 2.0, 2.5]);
        courses.begin(&shoot, Rays::Stored, GoesOn::No);
        courses.follow(&[moment(0.1)]);
        let names = (courses.last.name.as_str(), courses.before.name.as_str());
        assert_eq!(names, ("Shoot, rays stored", "Gather"));
        assert_eq!((times(&courses.last), times(&courses.before)), (vec![0.1], vec![1.0, 2.0, 2.5]));
        // One that was stopped before it had any light leaves the one before in sight.
        courses.begin(&shoot, Rays::Stored, GoesOn::No);
        courses.begin(&shoot, Rays::Stored, GoesOn::No);
        assert_eq!(times(&courses.before), [0.1]);
    }
}
