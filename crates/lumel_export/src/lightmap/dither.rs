//! Light as bytes.

use super::largest;
use crate::display::linear;
use glam::Vec3;

/// What bytes stand for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Curve {
    /// 255 times the light.
    Linear,
    /// The light on the sRGB curve: what glTF asks for in textures of colours, of which emission is one.
    Srgb,
}

impl Curve {
    /// The light of each byte; that of 255 is 1.
    fn light(self) -> [f64; 256] {
        std::array::from_fn(|byte| {
            let code = byte as f64 / 255.0;
            if self == Self::Srgb { linear(code) } else { code }
        })
    }
}

/// The largest value, which 255 stands for, and the values as bytes, [dithered](dithered_over).
pub(crate) fn dithered(values: &[Vec3], width: u32, curve: Curve) -> (f32, Vec<u8>) {
    let scale = largest(values);
    (scale, dithered_over(scale, values, width, curve))
}

/// Values as bytes, of which 255 stands for `scale`. Their mean over a few lumels is exact: which lumels are rounded up follows
/// a pattern that looks like noise (Jimenez, *Next Generation Post Processing in Call of Duty*, 2014).
pub(crate) fn dithered_over(scale: f32, values: &[Vec3], width: u32, curve: Curve) -> Vec<u8> {
    let light = curve.light();
    let white = f64::from(if scale > 0.0 { scale } else { 1.0 });
    let mut bytes = Vec::with_capacity(3 * values.len());
    for (lumel, value) in values.iter().enumerate() {
        let [x, y] = [lumel % width as usize, lumel / width as usize].map(|k| k as f64);
        for (channel, value) in value.to_array().into_iter().enumerate() {
            // Channels are rounded up in different places.
            let x = x + 5.588_238 * channel as f64;
            let threshold = (52.982_918_9 * (0.067_110_56 * x + 0.005_837_15 * y).fract()).fract();
            let exact = f64::from(value.max(0.0)) / white;
            let above = light.partition_point(|light| *light <= exact).min(255);
            let [low, high] = [light[above - 1], light[above]];
            let rounds_up = (exact - low) / (high - low) + threshold >= 1.0;
            bytes.push((above - usize::from(!rounds_up)) as u8);
        }
    }
    bytes
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn dithering_keeps_the_mean_light_of_any_small_block() {
        let width = 64;
        let mut worst: f64 = 0.0;
        for (curve, part) in
            [Curve::Linear, Curve::Srgb].into_iter().flat_map(|c| (0..40).map(move |p| (c, p)))
        {
            let light = curve.light();
            let step = light[101] - light[100];
            let value = light[100] + step * f64::from(part) / 40.0;
            // One lumel of the largest value sets the scale.
            let mut values = vec![Vec3::splat(value as f32); 64 * 64];
            values[0] = Vec3::ONE;
            let (scale, bytes) = dithered(&values, width, curve);
            assert_eq!((scale, &bytes[..3]), (1.0, &[255; 3][..]));
            let differ = bytes.chunks(3).filter(|channels| channels[0] != channels[1]).count();
            assert!(part == 0 || differ > 0, "channels are rounded up in different places");
            for (bx, by, channel) in
                (0..8).flat_map(|x| (1..8).flat_map(move |y| (0..3).map(move |c| (x, y, c))))
            {
                let byte = |i: usize| bytes[3 * ((8 * by + i / 8) * 64 + 8 * bx + i % 8) + channel];
                let sum: f64 = (0..64).map(|i| light[usize::from(byte(i))]).sum();
                worst = worst.max((sum / 64.0 - value).abs() / step);
            }
        }
        println!("{worst:.3} of a step");
        assert!(worst < 0.1, "{worst} of a step, in blocks of 8 by 8");
    }

    #[test]
    fn darkness_is_black_and_the_brightest_is_255() {
        for curve in [Curve::Linear, Curve::Srgb] {
            assert_eq!(dithered(&[Vec3::ZERO; 2], 1, curve), (0.0, vec![0; 6]));
            let values = [Vec3::splat(0.123), Vec3::new(0.0, -1.0, 0.123)];
            assert_eq!(dithered(&values, 2, curve), (0.123, vec![255, 255, 255, 0, 0, 255]));
        }
    }
}
