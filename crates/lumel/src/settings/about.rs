//! What is said about a setting, once for files, the command line, the window and the library.

/// What a setting influences, from most to least: what stays the same when it alone changes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Influence {
    /// Hemisphere rays, and so everything.
    Rays,
    /// Bounces, but not the hemisphere rays that measure them.
    Bounces,
    /// How many rays are stored. Bounces stay the same while the [`Method`](crate::Method) does.
    Storage,
    /// How many bounces there are. Each of them stays the same.
    Extent,
    /// What is made of the bounces in the end: their sum, with what is added to it, and its parts.
    Sum,
}

/// The numbers that a setting can have.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Bounds {
    /// All numbers of its type.
    Any,
    /// From the first to the second number, both included.
    Within(f64, f64),
    /// From the first to the second number, both excluded.
    Between(f64, f64),
}

impl Bounds {
    /// Whether a number lies within; NaN never does, unless there are no bounds.
    pub fn contain(self, number: f64) -> bool {
        match self {
            Self::Any => true,
            Self::Within(lo, hi) => (lo..=hi).contains(&number),
            Self::Between(lo, hi) => lo < number && number < hi,
        }
    }
}

/// What is said about a setting.
#[derive(Clone, Copy, Debug)]
pub struct About {
    /// Its name in files and in [`Settings`](crate::Settings): `direct_samples`.
    pub name: &'static str,
    /// Its names in files and command lines of earlier versions, which are still read.
    pub former: &'static [&'static str],
    /// Its name in a window: `Direct samples`.
    pub label: &'static str,
    /// What stands for its value in the help of the command line: `N`.
    pub placeholder: &'static str,
    /// What it has an influence on, at most.
    pub influence: Influence,
    /// The numbers that it can have.
    pub bounds: Bounds,
    /// The numbers that a slider offers, within the bounds.
    pub offered: Option<[f64; 2]>,
    /// Its documentation, as comments of code have it.
    pub(super) doc: &'static str,
}

impl About {
    /// Its name on the command line, without the dashes before it: `direct-samples`.
    pub fn flag(&self) -> String {
        self.name.replace('_', "-")
    }

    /// What it does, in one sentence.
    pub fn help(&self) -> String {
        self.paragraphs().next().unwrap_or_default()
    }

    /// What else there is to know, if there is anything: paragraphs with empty lines between them.
    pub fn details(&self) -> Option<String> {
        let details: Vec<String> = self.paragraphs().skip(1).collect();
        (!details.is_empty()).then(|| details.join("\n\n"))
    }

    fn paragraphs(&self) -> impl Iterator<Item = String> {
        // Each line of a comment begins with a space.
        self.doc.split("\n\n").map(|text| text.split_whitespace().collect::<Vec<_>>().join(" "))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_first_paragraph_of_a_comment_is_the_help_and_the_others_are_details() {
        let about = |doc| About {
            name: "a_b",
            former: &[],
            label: "",
            placeholder: "",
            influence: Influence::Sum,
            bounds: Bounds::Any,
            offered: None,
            doc,
        };
        let long = about(" One\n two.\n\n Three.\n\n Four\n five.\n");
        assert_eq!((long.help().as_str(), long.flag().as_str()), ("One two.", "a-b"));
        assert_eq!(long.details().as_deref(), Some("Three.\n\nFour five."));
        assert_eq!(about(" One.\n").details(), None);
    }
}
