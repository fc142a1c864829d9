//! Whether numbers hold the shape of an object.

use crate::mesh::ObjectMesh;
use crate::{SceneError, Warnings, rounding_of, triangle};

/// Edges of a triangle that is as many roundings high are bent by up to 1.8°; corners stay where they were.
const SOUND: f64 = 32.0;
/// A triangle that is no more roundings high may have any shape.
const LOST: f64 = 4.0;

/// The share of an object's triangles that may be bent without a warning.
const FEW: f64 = 0.1;
/// The share of lost ones that makes the object another one.
const MOST: f64 = 0.5;

/// Warns of an object whose triangles are hardly larger than the rounding of its coordinates.
///
/// # Errors
/// An object most of whose triangles are as small as that.
pub(crate) fn check(mesh: &ObjectMesh, warnings: &mut Warnings) -> Result<(), SceneError> {
    let (mut n, mut n_lost, mut n_bent, mut coarsest) = (0_u32, 0_u32, 0_u32, 0.0);
    for corners in mesh.faces.iter().map(|face| mesh.corners(face)) {
        let (height, longest) = (triangle::least_height(corners), triangle::longest_edge(corners));
        // Points and what is not finite are dropped anyway.
        if !corners.iter().all(|p| p.is_finite()) || longest == 0.0 {
            continue;
        }
        let largest = corners.iter().map(|p| p.abs().max_element()).fold(0.0, f32::max);
        let rounding = mesh.rounding.max(rounding_of(largest));
        // Needles without any width are drawn by people, too: their length counts.
        let size = if height < LOST * rounding { longest } else { height };
        n += 1;
        n_lost += u32::from(size < LOST * rounding);
        n_bent += u32::from(size < SOUND * rounding);
        coarsest = rounding.max(coarsest);
    }
    let more_than = |part: u32, share: f64| f64::from(part) > share * f64::from(n);
    if more_than(n_lost, MOST) {
        return Err(SceneError::Unresolved { object: mesh.name.clone(), rounding: coarsest });
    }
    if more_than(n_bent, FEW) {
        let message = format!(
            "{n_bent} of its {n} triangles are hardly larger than the {coarsest:.1e} m to which coordinates are rounded, \
             and light on them is doubtful: move it near the origin in the modelling program, or make it a scene of its own"
        );
        warnings.push(format!("object \"{}\"", mesh.name), message);
    }
    Ok(())
}
