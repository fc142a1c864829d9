//! Types of settings: how their values are written and read, and what they can be.

use super::about::{Bounds, Influence};
use super::adaptive::Adaptive;
use super::bounce_limit::BounceLimit;
use super::memory::Memory;
use super::point_spacing::PointSpacing;
use super::share::Share;
use super::target_error::TargetError;

/// A type of settings.
pub trait Value: Copy + PartialEq + Send + Sync + 'static {
    /// The value in words, which [`read`](Self::read) understands.
    fn text(&self) -> String;

    /// The value that a text says, if it says one.
    fn read(text: &str) -> Option<Self>;

    /// What values with these bounds are, to follow "it must be".
    fn expected(bounds: Bounds) -> String;

    /// The number that bounds are for, if this value is one.
    fn number(&self) -> Option<f64> {
        None
    }

    /// The values by name, of types that have only a few.
    fn choices() -> &'static [Choice] {
        &[]
    }

    /// The value that naming the setting alone means, if it means one.
    fn implied() -> Option<&'static str> {
        None
    }

    /// What a change from this value to another one influences, where a change of its setting usually has an influence.
    fn influence(&self, _other: &Self, usual: Influence) -> Influence {
        usual
    }

    /// The value, to be edited.
    fn slot(&mut self) -> Slot<'_>;
}

/// One of the few values of a type.
#[derive(Clone, Copy, Debug)]
pub struct Choice {
    /// Its name in files and on the command line.
    pub name: &'static str,
    /// Its names in files and command lines of earlier versions, which are still read.
    pub former: &'static [&'static str],
    /// Its name in a window.
    pub label: &'static str,
    /// What it means, in a few words that begin with a lower-case letter.
    pub help: &'static str,
}

/// A value to be edited, by type: for windows.
#[derive(Debug)]
pub enum Slot<'a> {
    /// One of the setting's choices, which is set by its name.
    Choice,
    /// A number of something.
    Count(&'a mut u32),
    /// A whole number.
    Whole(&'a mut u64),
    /// A number.
    Number(&'a mut f32),
    /// A number of bounces.
    Bounces(&'a mut BounceLimit),
    /// A size of memory.
    Memory(&'a mut Memory),
    /// A share.
    Share(&'a mut Share),
    /// A share that can be switched off, or left to the preset.
    Adaptive(&'a mut Adaptive),
    /// Whether points carry light, and how far they are apart.
    PointSpacing(&'a mut PointSpacing),
    /// A share that can be switched off.
    TargetError(&'a mut TargetError),
}

/// Gives a type with few values their names.
macro_rules! choices {
    (
        $kind:ident {
            $($variant:ident = $name:literal $(| $former:literal)*, $label:literal, $help:literal;)+
        }
        $($method:item)*
    ) => {
        impl $crate::settings::value::Value for $kind {
            fn text(&self) -> String {
                match self { $(Self::$variant => $name,)+ }.to_owned()
            }

            fn read(text: &str) -> Option<Self> {
                match text {
                    $($name $(| $former)* => Some(Self::$variant),)+
                    _ => None,
                }
            }

            fn expected(_: $crate::settings::about::Bounds) -> String {
                format!("one of {}", [$($name),+].join(", "))
            }

            fn choices() -> &'static [$crate::settings::value::Choice] {
                &[$($crate::settings::value::Choice {
                    name: $name,
                    former: &[$($former),*],
                    label: $label,
                    help: $help,
                },)+]
            }

            fn slot(&mut self) -> $crate::settings::value::Slot<'_> {
                $crate::settings::value::Slot::Choice
            }

            $($method)*
        }
    };
}
pub(super) use choices;

impl Value for u32 {
    fn text(&self) -> String {
        self.to_string()
    }

    fn read(text: &str) -> Option<Self> {
        text.trim().parse().ok()
    }

    fn expected(bounds: Bounds) -> String {
        whole(bounds, f64::from(Self::MAX))
    }

    fn number(&self) -> Option<f64> {
        Some(f64::from(*self))
    }

    fn slot(&mut self) -> Slot<'_> {
        Slot::Count(self)
    }
}

impl Value for u64 {
    fn text(&self) -> String {
        self.to_string()
    }

    fn read(text: &str) -> Option<Self> {
        text.trim().parse().ok()
    }

    fn expected(_: Bounds) -> String {
        format!("a whole number from 0 to {}", Self::MAX)
    }

    fn slot(&mut self) -> Slot<'_> {
        Slot::Whole(self)
    }
}

impl Value for f32 {
    fn text(&self) -> String {
        self.to_string()
    }

    fn read(text: &str) -> Option<Self> {
        text.trim().parse().ok()
    }

    fn expected(bounds: Bounds) -> String {
        match bounds {
            Bounds::Any => "a number".to_owned(),
            Bounds::Within(lo, hi) => format!("a number from {lo} to {hi}"),
            Bounds::Between(lo, hi) => format!("a number between {lo} and {hi}"),
        }
    }

    fn number(&self) -> Option<f64> {
        Some(f64::from(*self))
    }

    fn slot(&mut self) -> Slot<'_> {
        Slot::Number(self)
    }
}

impl Value for BounceLimit {
    fn text(&self) -> String {
        self.to_string()
    }

    fn read(text: &str) -> Option<Self> {
        text.trim().parse().ok()
    }

    fn expected(bounds: Bounds) -> String {
        format!("{}, or all", whole(bounds, f64::from(u32::MAX)))
    }

    fn number(&self) -> Option<f64> {
        match self {
            Self::Count(n) => Some(f64::from(*n)),
            Self::All => None,
        }
    }

    fn slot(&mut self) -> Slot<'_> {
        Slot::Bounces(self)
    }
}

impl Value for Memory {
    fn text(&self) -> String {
        self.to_string()
    }

    fn read(text: &str) -> Option<Self> {
        text.parse().ok()
    }

    fn expected(_: Bounds) -> String {
        "a size such as 500MB or 2GiB".to_owned()
    }

    fn slot(&mut self) -> Slot<'_> {
        Slot::Memory(self)
    }
}

impl Value for Share {
    fn text(&self) -> String {
        self.to_string()
    }

    fn read(text: &str) -> Option<Self> {
        text.parse().ok()
    }

    fn expected(_: Bounds) -> String {
        "a share between 0 and 1, such as 0.01 or 1%".to_owned()
    }

    fn slot(&mut self) -> Slot<'_> {
        Slot::Share(self)
    }
}

impl Value for Adaptive {
    fn text(&self) -> String {
        self.to_string()
    }

    fn read(text: &str) -> Option<Self> {
        text.trim().parse().ok()
    }

    fn expected(bounds: Bounds) -> String {
        format!("{}, auto or off", Share::expected(bounds))
    }

    fn implied() -> Option<&'static str> {
        Some("auto")
    }

    fn slot(&mut self) -> Slot<'_> {
        Slot::Adaptive(self)
    }
}

impl Value for PointSpacing {
    fn text(&self) -> String {
        self.to_string()
    }

    fn read(text: &str) -> Option<Self> {
        text.parse().ok()
    }

    fn expected(_: Bounds) -> String {
        "a length in metres greater than zero, a number of points such as \"50000 points\", auto or off"
            .to_owned()
    }

    fn slot(&mut self) -> Slot<'_> {
        Slot::PointSpacing(self)
    }
}

impl Value for TargetError {
    fn text(&self) -> String {
        self.to_string()
    }

    fn read(text: &str) -> Option<Self> {
        text.trim().parse().ok()
    }

    fn expected(bounds: Bounds) -> String {
        format!("{}, or off", Share::expected(bounds))
    }

    fn slot(&mut self) -> Slot<'_> {
        Slot::TargetError(self)
    }
}

fn whole(bounds: Bounds, most: f64) -> String {
    match bounds {
        Bounds::Any => format!("a whole number from 0 to {most}"),
        Bounds::Within(lo, hi) => format!("a whole number from {lo} to {hi}"),
        Bounds::Between(lo, hi) => format!("a whole number between {lo} and {hi}"),
    }
}
