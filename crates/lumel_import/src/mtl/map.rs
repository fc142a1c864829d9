//! The arguments of `map_Kd` and similar statements: options and a file name.

use glam::Vec2;
use lumel_scene::{UvTransform, Wrap};

/// An image and its mapping.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct MapStatement {
    /// The file name as written; it may contain blanks.
    pub(super) file: String,
    /// `-o`: added to the coordinate last.
    pub(super) offset: Vec2,
    /// `-s`: multiplies the coordinate first.
    pub(super) scale: Vec2,
    /// `-clamp`.
    pub(super) wrap: Wrap,
    /// `-bm`: how much steeper bumps are.
    pub(super) bump: f32,
    /// Whether `-mm` changes the values, which is not supported.
    pub(super) changes_values: bool,
}

impl MapStatement {
    /// Reads options before and after the file name; `None` if there is no name.
    pub(super) fn parse(text: &str) -> Option<Self> {
        let mut map = Self {
            file: String::new(),
            offset: Vec2::ZERO,
            scale: Vec2::ONE,
            wrap: Wrap::Repeat,
            bump: 1.0,
            changes_values: false,
        };
        let mut rest = text.trim();
        while let Some(after) = map.option(rest) {
            rest = after;
        }
        // The name goes on up to the next option: blanks may be part of it.
        let starts = rest.match_indices(char::is_whitespace).map(|(i, blank)| i + blank.len());
        let end = starts.filter(|&i| Kind::of(first_word(&rest[i..])).is_some()).min().unwrap_or(rest.len());
        map.file = rest[..end].trim().to_owned();
        rest = &rest[end..];
        while let Some(after) = map.option(rest) {
            rest = after;
        }
        (!map.file.is_empty()).then_some(map)
    }

    /// Takes one option with its values off the front of `text`; `None` if there is none.
    fn option<'a>(&mut self, text: &'a str) -> Option<&'a str> {
        let name = first_word(text);
        let kind = Kind::of(name)?;
        let mut rest = text[name.len()..].trim_start();
        let (mut values, mut count) = ([0.0_f32; 3], 0);
        if kind == Kind::Word {
            let word = first_word(rest);
            if name == "-clamp" && word == "on" {
                self.wrap = Wrap::Clamp;
            }
            rest = rest[word.len()..].trim_start();
        } else {
            // The number of values varies, so they end at the first word that is no number.
            while count < kind.most_numbers() {
                let word = first_word(rest);
                let Some(value) = number(word) else { break };
                values[count] = value;
                count += 1;
                rest = rest[word.len()..].trim_start();
            }
        }
        let [x, y, _] = values;
        match (name, count) {
            ("-o", 1..) => self.offset = Vec2::new(x, y),
            ("-s", 1) => self.scale.x = x,
            ("-s", 2..) => self.scale = Vec2::new(x, y),
            ("-bm", 1..) => self.bump = x,
            ("-mm", 1..) => self.changes_values = x != 0.0 || count > 1 && y != 1.0,
            _ => {}
        }
        Some(rest)
    }

    /// The map from mesh coordinates, which have `v` down, to the image's.
    ///
    /// The file's rule, for `v` up, is `scale * v + offset`. With both sides flipped it becomes
    /// `scale * v + (1 - scale - offset)`.
    pub(super) fn transform(&self) -> UvTransform {
        let offset = Vec2::new(self.offset.x, 1.0 - self.scale.y - self.offset.y);
        UvTransform { offset, rotation: 0.0, scale: self.scale }
    }
}

/// The arguments of an option.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Kind {
    /// One word.
    Word,
    /// Up to two numbers.
    Range,
    /// Up to three numbers.
    Vector,
    /// One number.
    Number,
}

impl Kind {
    fn of(word: &str) -> Option<Self> {
        match word {
            "-blendu" | "-blendv" | "-cc" | "-clamp" | "-colorspace" | "-imfchan" | "-texres" | "-type" => {
                Some(Self::Word)
            }
            "-mm" => Some(Self::Range),
            "-o" | "-s" | "-t" => Some(Self::Vector),
            "-bm" | "-boost" => Some(Self::Number),
            _ => None,
        }
    }

    fn most_numbers(self) -> usize {
        match self {
            Self::Word => 0,
            Self::Number => 1,
            Self::Range => 2,
            Self::Vector => 3,
        }
    }
}

fn first_word(text: &str) -> &str {
    text.split(char::is_whitespace).next().unwrap_or_default()
}

/// A finite number; a file may well be called "inf" or "nan".
fn number(word: &str) -> Option<f32> {
    word.parse().ok().filter(|value: &f32| value.is_finite())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn parse(text: &str) -> MapStatement {
        MapStatement::parse(text).unwrap()
    }

    #[test]
    fn names_are_found_between_any_options() {
        let cases = [
            ("wood.png", "wood.png"),
            ("  my wood 01.png ", "my wood 01.png"),
            ("-clamp on ambient.jpg", "ambient.jpg"),
            ("-o 0.1 diffuse.jpg", "diffuse.jpg"),
            ("-s 0.1 0.2 specular.jpg", "specular.jpg"),
            ("-t 0.1 0.2 0.3 highlight.jpg", "highlight.jpg"),
            ("-bm 3 bump map.jpg", "bump map.jpg"),
            ("-imfchan r bump2.jpg -bm 1.5", "bump2.jpg"),
            ("a file.jpg -bm 1.5 -clamp on", "a file.jpg"),
            ("-type cube_top -texres 512 -mm 0.1 0.3 -cc on -blendu off -blendv on -boost 2 x.png", "x.png"),
            ("-s 1 1 1 inf", "inf"),
            ("tex\\wood-o.png", "tex\\wood-o.png"),
            ("-dashing.png", "-dashing.png"),
        ];
        for (text, file) in cases {
            assert_eq!(parse(text).file, file, "{text}");
        }
        for text in ["", "  ", "-bm 3", "-clamp", "-s 1 2 3"] {
            assert_eq!(MapStatement::parse(text), None, "{text}");
        }
    }

    #[test]
    fn offset_and_scale_act_on_coordinates_with_v_up() {
        let map = parse("-s 2 3 1 -o 0.25 0.5 0 wood.png -clamp on");
        assert_eq!(
            (map.scale, map.offset, map.wrap),
            (Vec2::new(2.0, 3.0), Vec2::new(0.25, 0.5), Wrap::Clamp)
        );
        let up = Vec2::new(0.125, 0.75);
        let expected_up = Vec2::new(2.0 * up.x + 0.25, 3.0 * up.y + 0.5);
        let down = map.transform().apply(Vec2::new(up.x, 1.0 - up.y));
        assert!((down - Vec2::new(expected_up.x, 1.0 - expected_up.y)).length() < 1e-6, "{down}");
        assert_eq!(parse("wood.png").transform(), UvTransform::default());
        assert_eq!(parse("-s 2 wood.png").scale, Vec2::new(2.0, 1.0));
        assert_eq!([parse("wood.png").bump, parse("wood.png -bm 0.25").bump], [1.0, 0.25]);
    }

    #[test]
    fn values_that_would_be_changed_are_noticed() {
        assert!(parse("-mm 0.1 0.3 x.png").changes_values);
        assert!(!parse("-mm 0 1 x.png").changes_values);
        assert!(!parse("x.png").changes_values);
    }
}
