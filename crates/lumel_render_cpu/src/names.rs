//! Names of settings, as on the command line and in settings files.

/// The text is not the name of a value of the setting.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("unknown {what} \"{name}\": expected one of {}", .expected.join(", "))]
pub struct UnknownName {
    pub(crate) what: &'static str,
    pub(crate) name: String,
    pub(crate) expected: &'static [&'static str],
}

/// Gives the variants of an enum their names: `ALL`, `NAMES`, `name()`, `Display` and `FromStr`.
macro_rules! named {
    ($type:ident, $what:literal, $($variant:ident $(($($of:tt)+))? = $name:expr),+ $(,)?) => {
        impl $type {
            /// All values.
            pub const ALL: &'static [Self] = &[$(Self::$variant $(($($of)+))?),+];

            /// The names of [`ALL`](Self::ALL), in the same order.
            pub const NAMES: &'static [&'static str] = &[$($name),+];

            /// The name on the command line and in settings.
            pub const fn name(self) -> &'static str {
                match self {
                    $(Self::$variant $(($($of)+))? => $name),+
                }
            }
        }

        impl std::fmt::Display for $type {
            fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
                f.pad(self.name())
            }
        }

        impl std::str::FromStr for $type {
            type Err = $crate::UnknownName;

            fn from_str(name: &str) -> Result<Self, $crate::UnknownName> {
                Self::ALL.iter().copied().find(|value| value.name() == name).ok_or_else(|| $crate::UnknownName {
                    what: $what,
                    name: name.to_owned(),
                    expected: Self::NAMES,
                })
            }
        }
    };
}

pub(crate) use named;
