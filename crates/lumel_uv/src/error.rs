//! Why there is no atlas.

/// Why there is no atlas.
#[derive(Debug, thiserror::Error, PartialEq)]
pub enum UvError {
    /// A setting is outside its bounds.
    #[error("the {setting} is {value}; it must be {expected}")]
    Setting {
        /// Which one.
        setting: &'static str,
        /// Its value.
        value: f64,
        /// What it may be.
        expected: &'static str,
    },
    /// The pages would have more lumels than can be numbered.
    #[error("the atlas would have {lumels} lumels; the limit is {limit}")]
    TooLarge {
        /// How many lumels it would have.
        lumels: u64,
        /// How many it may have.
        limit: u64,
    },
    /// The caller said stop.
    #[error("unwrapping was stopped")]
    Stopped,
}
