//! Which corners make a triangle.

use gltf_json::mesh::Mode;

/// How many triangles `n` corners make; `None` for points and lines.
pub(super) fn triangle_count(mode: Mode, n: usize) -> Option<usize> {
    match mode {
        Mode::Triangles => Some(n / 3),
        Mode::TriangleStrip | Mode::TriangleFan => Some(n.saturating_sub(2)),
        Mode::Points | Mode::Lines | Mode::LineLoop | Mode::LineStrip => None,
    }
}

/// The corners of triangle `i`, counter-clockwise seen from the front.
///
/// Khronos Group, *glTF 2.0 Specification*, 3.7.2.1. Every second triangle of a strip is reversed.
pub(super) fn corners(mode: Mode, i: usize) -> [usize; 3] {
    match mode {
        Mode::TriangleStrip => [i, i + 1 + i % 2, i + 2 - i % 2],
        Mode::TriangleFan => [i + 1, i + 2, 0],
        _ => [3 * i, 3 * i + 1, 3 * i + 2],
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn triangles(mode: Mode, n: usize) -> Vec<[usize; 3]> {
        (0..triangle_count(mode, n).unwrap()).map(|i| corners(mode, i)).collect()
    }

    #[test]
    fn strips_and_fans_keep_every_triangle_turned_the_same_way() {
        assert_eq!(triangles(Mode::TriangleStrip, 5), [[0, 1, 2], [1, 3, 2], [2, 3, 4]]);
        assert_eq!(triangles(Mode::TriangleFan, 5), [[1, 2, 0], [2, 3, 0], [3, 4, 0]]);
        assert_eq!(triangles(Mode::Triangles, 6), [[0, 1, 2], [3, 4, 5]]);
    }

    #[test]
    fn too_few_corners_make_no_triangle() {
        for mode in [Mode::Triangles, Mode::TriangleStrip, Mode::TriangleFan] {
            assert!((0..3).all(|n| triangles(mode, n).is_empty()), "{mode:?}");
        }
        assert_eq!(triangles(Mode::Triangles, 8).len(), 2);
        assert_eq!(triangle_count(Mode::LineStrip, 9), None);
    }
}
