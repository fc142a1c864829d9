//! Why settings cannot be used.

/// Why settings cannot be used. Names are those of files and of [`Settings`](super::Settings).
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum SettingsError {
    /// A value that the setting cannot have.
    #[error("{setting} is {value} but must be {expected}")]
    Invalid {
        /// The setting.
        setting: &'static str,
        /// Its value, as it was written.
        value: String,
        /// What it can be.
        expected: String,
    },
    /// Two values that exclude each other.
    #[error("{setting} {value} and {other} {other_value} exclude each other: {reason}")]
    Conflict {
        /// A setting.
        setting: &'static str,
        /// Its value.
        value: String,
        /// The other setting.
        other: &'static str,
        /// Its value.
        other_value: String,
        /// Why they exclude each other.
        reason: &'static str,
    },
    /// No value for a setting that differs between presets, and no preset.
    #[error("{setting} is missing; set it or name a preset")]
    Missing {
        /// The setting.
        setting: &'static str,
    },
}

impl SettingsError {
    /// The name of the setting at fault.
    pub fn setting(&self) -> &'static str {
        match self {
            Self::Invalid { setting, .. } | Self::Conflict { setting, .. } | Self::Missing { setting } => {
                setting
            }
        }
    }

    /// What to do about it.
    pub fn remedy(&self) -> String {
        match self {
            Self::Invalid { expected, .. } => format!("it must be {expected}"),
            Self::Conflict { setting, other, .. } => format!("change {setting} or {other}"),
            Self::Missing { setting } => format!("set {setting} or name a preset"),
        }
    }
}
