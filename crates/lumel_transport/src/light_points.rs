//! Sample points of lights in an order that keeps neighbours together.

use lumel_sample::{CellOrder, Stream};

/// Points of a stream, sorted so that any run of them covers little of a light, or few lights: shadow rays through it
/// are a narrow beam.
#[derive(Default)]
pub(crate) struct LightPoints {
    cells: CellOrder,
    choices: Vec<([f32; 2], f32)>,
}

impl LightPoints {
    /// The first `n` points of `stream`.
    pub(crate) fn fill(&mut self, stream: &Stream, n: u32) -> &[[f32; 2]] {
        self.cells.points(stream, n)
    }

    /// The first `n` points of `stream`, each with a third coordinate that chooses a light, in the order of that.
    pub(crate) fn fill_by_choice(&mut self, stream: &Stream, n: u32) -> &[([f32; 2], f32)] {
        self.choices.clear();
        self.choices.extend((0..n).map(|i| {
            let [x, y, choice, _] = stream.sample_4d(i);
            ([x, y], choice)
        }));
        // Equal in all coordinates is equal: the order of such points cannot matter.
        let key = |(u, choice): &([f32; 2], f32)| [*choice, u[0], u[1]].map(f32::to_bits);
        self.choices.sort_unstable_by_key(key);
        &self.choices
    }
}
