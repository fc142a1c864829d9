//! What a solve says of the light at lumels.

use glam::Vec3;

/// The light of a solve at the middle of each lumel, W·m⁻². By default, nothing is known.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct SolvedLight {
    /// Direct light by lumel; empty where that is not known.
    pub direct: Vec<Vec3>,
    /// The sum of all bounces by lumel, likewise.
    pub bounces: Vec<Vec3>,
}

/// A part of the light that is compared with the solve.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Part {
    Direct,
    Bounces,
}

impl Part {
    pub(crate) const ALL: [Self; 2] = [Self::Direct, Self::Bounces];

    /// Its sources among all.
    pub(crate) fn of<T>(self, sources: &[T]) -> &[T] {
        let (direct, bounces) = sources.split_at(sources.len().min(1));
        if let Self::Direct = self { direct } else { bounces }
    }

    pub(crate) fn of_mut<T>(self, sources: &mut [T]) -> &mut [T] {
        let (direct, bounces) = sources.split_at_mut(sources.len().min(1));
        if let Self::Direct = self { direct } else { bounces }
    }
}

impl SolvedLight {
    /// That of a part by lumel; `None` if it is not known.
    pub(crate) fn part(&self, part: Part) -> Option<&[Vec3]> {
        let light = match part {
            Part::Direct => &self.direct,
            Part::Bounces => &self.bounces,
        };
        Some(light.as_slice()).filter(|light| !light.is_empty())
    }
}
