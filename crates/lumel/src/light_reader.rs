//! How the light of one solve is read.

use crate::settings::TargetError;
use crate::{Baker, Projection};
use glam::Vec3;
use lumel_basis::{Coefficients, Field, LeastSquares, Limits};
use lumel_solve::{ShotLight, SolveState};
use std::borrow::Cow;

/// Reads fields of one solve as its projection asks for.
///
/// Linear in the field: what is read of bounces or layers adds up to what is read of their sum. With least squares,
/// the edges of direct light decide where values are kept from overshooting, for all fields of the solve alike.
pub struct LightReader<'a> {
    baker: &'a Baker,
    /// `None` where light is read as it is carried.
    least_squares: Option<(&'a LeastSquares, Limits)>,
    /// Direct light at the vertices, where it was measured there apart from what bounces carry, and as these carry it.
    direct: Option<[Vec<Vec3>; 2]>,
}

impl Baker {
    /// How the fields of a solve are read. Its direct light must be there.
    pub fn light_reader(&self, state: &SolveState) -> LightReader<'_> {
        let least_squares = self.least_squares().zip(state.bounces.first());
        let least_squares = least_squares.map(|(solver, direct)| (solver, solver.limits(direct)));
        let reader = LightReader { baker: self, least_squares, direct: None };
        let carried = state.bounces.first().map(|direct| reader.at_vertices(direct));
        // With a target error, it is the light of the points whose errors are known.
        let is_read = self.settings().target_error == TargetError::Off;
        let measured = state.read_direct.as_ref().filter(|_| is_read);
        let measured = measured.map(|direct| self.measured_at_vertices(direct));
        LightReader { direct: measured.zip(carried).map(|(measured, carried)| [measured, carried]), ..reader }
    }

    /// Direct light that was measured at the vertices, as the projection says, where points carry the bounces.
    fn measured_at_vertices(&self, direct: &Field) -> Vec<Vec3> {
        let surfaces = self.surfaces();
        let mut direct = direct.clone();
        if self.settings().projection == Projection::LeastSquares {
            let solver = surfaces.least_squares();
            let limits = solver.limits(&direct);
            solver.project_within(&limits, &mut direct);
        }
        surfaces.points.read(&*surfaces.vertices, &direct)
    }
}

impl LightReader<'_> {
    /// What solves the state whose fields it reads.
    pub fn baker(&self) -> &Baker {
        self.baker
    }

    /// A field of the solve at every vertex of the scene, W·m⁻².
    ///
    /// Bounces and layers may be negative, so that they add up.
    pub fn at_vertices(&self, field: &Field) -> Vec<Vec3> {
        self.baker.carried_at_vertices(&self.read(field))
    }

    /// Direct light at every vertex of the scene, W·m⁻², if it was measured there apart from what points carry.
    pub fn direct_at_vertices(&self) -> Option<&[Vec3]> {
        self.direct.as_ref().map(|[measured, _]| measured.as_slice())
    }

    /// Light at vertices that contains all direct light, with the direct light that was measured there.
    pub(crate) fn with_direct(&self, mut light: Vec<Vec3>) -> Vec<Vec3> {
        if let Some([measured, carried]) = &self.direct {
            let other = measured.iter().zip(carried).map(|(measured, carried)| *measured - *carried);
            light.iter_mut().zip(other).for_each(|(light, other)| *light += other);
        }
        light
    }

    /// The coefficients of harmonics of a field of the solve at every vertex of the scene, W·m⁻²; `None` for irradiance alone.
    ///
    /// They are read as irradiance is, with the same limits.
    pub fn directional_at_vertices(&self, field: &Field) -> Option<Coefficients> {
        self.baker.surfaces().points.read_directional(&**self.baker.basis(), &self.read(field))
    }

    /// All light of the solve at every vertex of the scene, W·m⁻², never negative.
    pub(crate) fn all_at_vertices(&self, state: &SolveState) -> Vec<Vec3> {
        if state.bounces.is_empty() {
            return vec![Vec3::ZERO; self.baker.scene().vertex_count()];
        }
        positive(self.with_direct(self.at_vertices(&state.total())))
    }

    /// All light, or a mixture of all layers, at every vertex of the scene, W·m⁻², never negative.
    pub(crate) fn positive_at_vertices(&self, field: &Field) -> Vec<Vec3> {
        positive(self.at_vertices(field))
    }

    /// A state with the coefficients to read in place of those that bounces carry; without layers. All light is what its
    /// fields add up to: no field has to be read for it.
    pub(crate) fn read_state<'s>(&self, state: &'s SolveState) -> Cow<'s, SolveState> {
        if self.least_squares.is_none() {
            return Cow::Borrowed(state);
        }
        let read = |field: &Field| self.read(field).into_owned();
        Cow::Owned(SolveState {
            bounces: state.bounces.iter().map(read).collect(),
            shot: state.shot.as_ref().map(|shot| ShotLight {
                reflected: read(&shot.reflected),
                unshot: read(&shot.unshot),
                shots: shot.shots,
            }),
            tail: state.tail.as_ref().map(read),
            gathered: state.gathered.as_ref().map(read),
            ..SolveState::new()
        })
    }

    /// The coefficients to read of a field that bounces carry.
    pub(crate) fn read<'f>(&self, field: &'f Field) -> Cow<'f, Field> {
        let Some((solver, limits)) = &self.least_squares else { return Cow::Borrowed(field) };
        let mut field = field.clone();
        solver.project_within(limits, &mut field);
        Cow::Owned(field)
    }
}

/// The same where values are positive, and zero where they are not.
pub(crate) fn positive(mut values: Vec<Vec3>) -> Vec<Vec3> {
    values.iter_mut().for_each(|value| *value = value.max(Vec3::ZERO));
    values
}
