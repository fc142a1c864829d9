//! Light at lumels that is still being measured: a part of a checkpoint.

use crate::members::{check_members, read_flags, read_numbers, read_vectors};
use crate::{Array, ArrayData, NpzReader, NpzWriter, ReadError, SolutionError};
use lumel_lightmap::{DirectionalLight, Half, LumelLight};
use serde::{Deserialize, Serialize};
use std::io;

/// Light at lumels and what decides which lumels they are.
#[derive(Clone, Copy, Debug)]
pub struct LumelState<'a> {
    /// The identity of the receivers, hexadecimal.
    pub identity: &'a str,
    /// What was measured.
    pub light: &'a LumelLight,
}

/// The part of `meta.json` that arrays do not tell.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct LumelMeta {
    /// The identity of the receivers, hexadecimal.
    pub identity: String,
    /// Sources of light, one array each.
    pub sources: usize,
    /// See [`LumelLight::has_tail`].
    pub has_tail: bool,
    /// See [`LumelLight::round`].
    pub round: u32,
    /// See [`LumelLight::done`].
    pub done: u32,
    /// Coefficients of harmonics, one array each.
    #[serde(default, skip_serializing_if = "is_zero")]
    pub harmonics: usize,
    /// Lumels that were measured by direction.
    #[serde(default, skip_serializing_if = "is_zero")]
    pub directional_done: usize,
}

#[expect(clippy::trivially_copy_pass_by_ref, reason = "as serde calls it")]
fn is_zero(n: &usize) -> bool {
    *n == 0
}

const ACTIVE: &str = "lumel_active";

fn source(number: usize) -> String {
    format!("lumel_source_{number}")
}

fn harmonic(number: usize) -> String {
    format!("lumel_sh_{number}")
}

fn samples(half: usize) -> String {
    format!("lumel_samples_{half}")
}

fn totals(half: usize) -> String {
    format!("lumel_totals_{half}")
}

fn bounced(half: usize) -> String {
    format!("lumel_bounced_{half}")
}

impl LumelState<'_> {
    pub(crate) fn meta(&self) -> LumelMeta {
        let LumelLight { has_tail, round, done, ref sources, ref directional, .. } = *self.light;
        LumelMeta {
            identity: self.identity.to_owned(),
            sources: sources.len(),
            has_tail,
            round,
            done,
            harmonics: directional.harmonics.len(),
            directional_done: directional.done as usize,
        }
    }

    pub(crate) fn write(&self, npz: &mut NpzWriter<'_>) -> io::Result<()> {
        let list = |values: &[f32]| Array::list(ArrayData::F32(values.to_vec()));
        for (number, values) in self.light.sources.iter().enumerate() {
            npz.array(&source(number), &Array::from_vectors(values))?;
        }
        for (number, values) in self.light.directional.harmonics.iter().enumerate() {
            npz.array(&harmonic(number), &Array::from_vectors(values))?;
        }
        for (number, half) in self.light.halves.iter().enumerate() {
            npz.array(&samples(number), &list(&half.samples))?;
            npz.array(&totals(number), &list(&half.totals))?;
            npz.array(&bounced(number), &list(&half.bounced))?;
        }
        npz.array(ACTIVE, &Array::list(ArrayData::Bool(self.light.active.clone())))
    }
}

impl LumelMeta {
    /// Whether it is light at the lumels of this identity.
    pub(crate) fn is_of(&self, identity: &str) -> bool {
        self.identity == identity
    }

    pub(crate) fn read(&self, npz: &mut NpzReader) -> Result<LumelLight, SolutionError> {
        let of_halves = (0..2).flat_map(|half| [samples(half), totals(half), bounced(half)]);
        let names = (0..self.sources).map(source).chain(of_halves);
        let names = names.chain((0..self.harmonics).map(harmonic));
        let names: Vec<String> = names.chain([ACTIVE.to_owned()]).collect();
        check_members(npz, &names)?;
        let mut half = |number| {
            Ok(Half {
                samples: read_numbers(npz, &samples(number))?,
                totals: read_numbers(npz, &totals(number))?,
                bounced: read_numbers(npz, &bounced(number))?,
            })
        };
        let halves: [Result<Half, SolutionError>; 2] = [half(0), half(1)];
        let [first, second] = halves;
        let light = LumelLight {
            halves: [first?, second?],
            sources: (0..self.sources)
                .map(|number| read_vectors(npz, &source(number)))
                .collect::<Result<_, _>>()?,
            has_tail: self.has_tail && self.sources > 0,
            round: self.round,
            active: read_flags(npz, ACTIVE)?,
            done: self.done,
            directional: DirectionalLight {
                harmonics: (0..self.harmonics)
                    .map(|number| read_vectors(npz, &harmonic(number)))
                    .collect::<Result<_, _>>()?,
                done: self.directional_done as u32,
            },
        };
        light
            .check()
            .map_err(|problem| {
                let (path, member) = (npz.path().to_owned(), ACTIVE.to_owned());
                ReadError::BadMember { path, member, problem }.into()
            })
            .map(|()| light)
    }
}
