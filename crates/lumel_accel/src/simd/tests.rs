//! Every instruction set against the portable one.

use super::{InstructionSet, Kernel, Lanes, Permute, Quads, Simd};

/// All operations on some awkward numbers, as bits.
#[derive(Clone, Copy)]
struct Everything;

const A: [f32; 16] = [
    0.0,
    -0.0,
    1.0,
    -1.5,
    1e-30,
    3e38,
    -3e38,
    7.25,
    0.1,
    0.2,
    -0.3,
    f32::INFINITY,
    f32::NEG_INFINITY,
    1e-40,
    5.0,
    -5.0,
];
const B: [f32; 16] =
    [-0.0, 0.0, 3.0, 0.7, -1e-30, 2.0, 3e38, 7.25, 10.0, -0.2, 0.3, 1.0, 2.0, 1e-40, -5.0, 0.1];

impl Kernel for Everything {
    type Output = Vec<u32>;

    #[inline(always)]
    fn run<S: Simd>(self, isa: S) -> Vec<u32> {
        let mut out = Vec::new();
        for shift in 0..16 {
            let turned = |v: [f32; 16]| -> [f32; 16] { std::array::from_fn(|i| v[(i + shift) % 16]) };
            let (a, b) = (turned(A), B);
            let c = turned(B);
            all_of::<S::F16>(isa, &a, &b, &c, &mut out, |v, o| o.extend(v.map(f32::to_bits)));
            let eight = |v: &[f32; 16]| -> [f32; 8] { std::array::from_fn(|i| v[i + 3]) };
            all_of::<S::F8>(isa, &eight(&a), &eight(&b), &eight(&c), &mut out, |v, o| {
                o.extend(v.map(f32::to_bits));
            });
            let four = |v: &[f32; 16]| -> [f32; 4] { std::array::from_fn(|i| v[i + 7]) };
            all_of::<S::F4>(isa, &four(&a), &four(&b), &four(&c), &mut out, |v, o| {
                o.extend(v.map(f32::to_bits))
            });

            let mut eights = [0.0; 8];
            S::F8::load(isa, &eight(&a)).permute(0o26143507 >> (shift % 3)).store(&mut eights);
            out.extend(eights.map(f32::to_bits));
            let mut sixteen = [0.0; 16];
            S::F16::repeat(isa, S::F4::load(isa, &four(&a))).store(&mut sixteen);
            out.extend(sixteen.map(f32::to_bits));
            S::F16::load(isa, &a).spread([shift as u8, 15, 0, 7]).store(&mut sixteen);
            out.extend(sixteen.map(f32::to_bits));
        }
        out
    }
}

#[inline(always)]
fn all_of<L: Lanes>(
    isa: L::Isa,
    a: &L::Array,
    b: &L::Array,
    c: &L::Array,
    out: &mut Vec<u32>,
    keep: impl Fn(L::Array, &mut Vec<u32>),
) {
    let (x, y, z) = (L::load(isa, a), L::load(isa, b), L::load(isa, c));
    let marked = L::splat(isa, f32::from_bits(0x7fa0_0001));
    let results = [
        x.add(y),
        x.sub(y),
        x.mul(y),
        x.div(y),
        x.mul_add(y, z),
        x.mul_sub(y, z),
        x.abs(),
        x.flip(y),
        x.replace(y, 0b1011_0010_0110_1001),
        x.replace(marked, 0b0100_1101_1001_0110),
        // Which of two zeros is not prescribed; the sign of others is looked at below.
        x.min(y).abs(),
        x.max(y).abs(),
    ];
    for result in results {
        let mut array = *a;
        // The sign and payload of a NaN that an operation makes are not prescribed.
        result.store(&mut array);
        keep(array, out);
    }
    out.extend([x.lt(y), x.le(y), y.lt(x), y.le(x), x.negative()]);
    let zero = L::splat(isa, 0.0);
    out.extend([x.min(y).lt(zero), x.max(y).lt(zero)]);
    // Adding zero turns -0 into 0.
    out.extend([x.smallest(), y.largest(), z.smallest(), x.largest()].map(|v| (v + 0.0).to_bits()));
}

/// Results that are NaN are the same whatever their bits, except the one that was put there.
fn canonical(bits: Vec<u32>) -> Vec<u32> {
    let any_nan = |b: u32| if f32::from_bits(b).is_nan() && b != 0x7fa0_0001 { 0x7fc0_0000 } else { b };
    bits.into_iter().map(any_nan).collect()
}

#[test]
fn every_instruction_set_computes_the_same_bits() {
    let expected = canonical(InstructionSet::Portable.run(Everything));
    let available = InstructionSet::available();
    println!("instruction sets of this machine: {available:?}");
    for set in available {
        let found = canonical(set.run(Everything));
        assert_eq!(found.len(), expected.len());
        let wrong = found.iter().zip(&expected).position(|(a, b)| a != b);
        assert_eq!(wrong, None, "{set}: value {wrong:?} differs");
    }
}

#[test]
fn masks_have_the_first_lane_in_the_lowest_bit() {
    struct Mask;
    impl Kernel for Mask {
        type Output = [u32; 2];

        #[inline(always)]
        fn run<S: Simd>(self, isa: S) -> [u32; 2] {
            let ramp: [f32; 16] = std::array::from_fn(|i| i as f32);
            let below = S::F16::load(isa, &ramp).lt(S::F16::splat(isa, 3.0));
            let mut array = [0.0; 16];
            S::F16::splat(isa, 0.0).replace(S::F16::splat(isa, 1.0), 0b1000_0000_0000_0010).store(&mut array);
            [below, array.iter().enumerate().map(|(i, &x)| (x as u32) << i).sum()]
        }
    }
    for set in InstructionSet::available() {
        assert_eq!(set.run(Mask), [0b111, 0b1000_0000_0000_0010], "{set}");
    }
}
