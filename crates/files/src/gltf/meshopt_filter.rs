//! The filters of EXT_meshopt_compression (its appendix B), and the one that
//! KHR_meshopt_compression adds: what is done to elements after their stream was decoded.
//!
//! * OCTAHEDRAL: a unit vector from an octahedron's unfolded faces (Meyer et al. 2010);
//! * QUATERNION: the largest component of four from the other three;
//! * EXPONENTIAL: floats of an 8-bit exponent and a 24-bit mantissa;
//! * COLOR: RGB from luma and two differences (YCoCg-R).
//!
//! Contract: elements keep their size; numbers are rounded as meshoptimizer rounds them.

/// A filter, for elements of a size that it has.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Filter {
    Octahedral8,
    Octahedral16,
    Quaternion,
    Exponential,
    Color8,
    Color16,
}

impl Filter {
    /// The filter of this name for elements of so many bytes.
    pub fn of(name: &str, stride: usize) -> Option<Self> {
        Some(match (name, stride) {
            ("OCTAHEDRAL", 4) => Self::Octahedral8,
            ("OCTAHEDRAL", 8) => Self::Octahedral16,
            ("QUATERNION", 8) => Self::Quaternion,
            ("EXPONENTIAL", stride) if stride > 0 && stride.is_multiple_of(4) => Self::Exponential,
            ("COLOR", 4) => Self::Color8,
            ("COLOR", 8) => Self::Color16,
            _ => return None,
        })
    }

    /// Filters all elements in place.
    pub fn apply(self, bytes: &mut [u8]) {
        match self {
            Self::Octahedral8 => {
                for element in bytes.as_chunks_mut::<4>().0 {
                    let [x, y, one, w] = element.map(|b| b as i8);
                    let vector = octahedral([x, y, one].map(f32::from), 127.0);
                    let [x, y, z] = vector.map(|v| v as i8);
                    *element = [x, y, z, w].map(|v| v as u8);
                }
            }
            Self::Octahedral16 => shorts(bytes, |[x, y, one, w]| {
                let [x, y, z] = octahedral([x, y, one].map(f32::from), 32767.0).map(|v| v as i16);
                [x, y, z, w]
            }),
            Self::Quaternion => shorts(bytes, quaternion),
            Self::Exponential => {
                for element in bytes.as_chunks_mut::<4>().0 {
                    *element = exponential(u32::from_le_bytes(*element)).to_le_bytes();
                }
            }
            Self::Color8 => {
                for element in bytes.as_chunks_mut::<4>().0 {
                    let [y, co, cg, a] = *element;
                    let (co, cg) = (i32::from(co as i8), i32::from(cg as i8));
                    *element = color([y.into(), co, cg, a.into()], 255.0).map(|v| v as u8);
                }
            }
            Self::Color16 => shorts(bytes, |[y, co, cg, a]| {
                let unsigned = |v: i16| i32::from(v as u16);
                color([unsigned(y), co.into(), cg.into(), unsigned(a)], 65535.0).map(|v| v as u16 as i16)
            }),
        }
    }
}

fn shorts(bytes: &mut [u8], filter: impl Fn([i16; 4]) -> [i16; 4]) {
    for element in bytes.as_chunks_mut::<8>().0 {
        let [a, b, c, d, e, f, g, h] = *element;
        let filtered = filter([[a, b], [c, d], [e, f], [g, h]].map(i16::from_le_bytes));
        element.copy_from_slice(filtered.map(i16::to_le_bytes).as_flattened());
    }
}

/// Half is added away from zero, and the rest cut off by the conversion.
fn rounded(value: f32) -> f32 {
    value + if value >= 0.0 { 0.5 } else { -0.5 }
}

/// The third number is what stands for 1.
fn octahedral([x, y, one]: [f32; 3], largest: f32) -> [f32; 3] {
    let z = one - x.abs() - y.abs();
    let t = z.min(0.0);
    let x = x + if x >= 0.0 { t } else { -t };
    let y = y + if y >= 0.0 { t } else { -t };
    let scale = largest / (x * x + y * y + z * z).sqrt();
    [x, y, z].map(|v| rounded(v * scale))
}

/// The fourth number holds which component was left out in its last two bits, and what stands for
/// the largest value of the others, √½, with those bits set.
fn quaternion([x, y, z, w]: [i16; 4]) -> [i16; 4] {
    let scale = std::f32::consts::FRAC_1_SQRT_2 / f32::from(w | 3);
    let [x, y, z] = [x, y, z].map(|v| f32::from(v) * scale);
    let largest = (1.0 - x * x - y * y - z * z).max(0.0).sqrt();
    let [x, y, z, largest] = [x, y, z, largest].map(|v| rounded(v * 32767.0) as i16);
    let mut out = [0; 4];
    let left_out = (w & 3) as usize;
    for (k, value) in [largest, x, y, z].into_iter().enumerate() {
        out[(left_out + k) & 3] = value;
    }
    out
}

fn exponential(bits: u32) -> f32 {
    let exponent = bits as i32 >> 24;
    let mantissa = (bits << 8) as i32 >> 8;
    // 2^e by its bits, as meshoptimizer does it: exponents are never those of subnormal numbers.
    f32::from_bits(((exponent + 127) as u32) << 23) * mantissa as f32
}

/// Luma, orange and green differences, and alpha with the number of bits in its leading one.
fn color([y, co, cg, a]: [i32; 4], largest: f32) -> [f32; 4] {
    // All bits below and with the highest that is set: what stands for 1 in the other three.
    let bits = 32 - (a as u32).leading_zeros();
    let one = if bits == 0 { 0 } else { (1i64 << bits) - 1 } as i32;
    let (red, green, blue) = (y + co - cg, y + cg, y - co - cg);
    // Alpha has one bit less, shifted up over the marker, whose lowest bit is made a copy.
    let alpha = (a << 1 & one) | (a & 1);
    let scale = largest / one as f32;
    [red, green, blue, alpha].map(|v| (v as f32 * scale + 0.5).clamp(0.0, largest))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn noise(count: usize) -> Vec<[f32; 4]> {
        let mut state = 1u64;
        let mut next = || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
            (state >> 40) as f32 / (1 << 23) as f32 - 1.0
        };
        (0..count).map(|_| [next(), next(), next(), next()]).collect()
    }

    fn unit(v: [f32; 4], n: usize) -> [f32; 4] {
        let length = v[..n].iter().map(|x| x * x).sum::<f32>().sqrt();
        let mut out = v;
        out[..n].iter_mut().for_each(|x| *x /= length);
        out
    }

    /// Protects normals, rotations, floats and colours: what meshoptimizer encodes comes out as
    /// meshoptimizer itself decodes it.
    #[test]
    fn filters_agree_with_meshoptimizer() {
        let near = |a: i64, b: i64| (a - b).abs() <= 1;
        let vectors: Vec<[f32; 4]> = noise(500).iter().map(|v| unit(*v, 3)).collect();
        let encoded: Vec<[i8; 4]> = meshopt::encode_filter_oct(&vectors, 7);
        let mut ours: Vec<u8> = encoded.as_flattened().iter().map(|&b| b as u8).collect();
        let mut theirs = encoded.clone();
        meshopt::decode_filter_oct(&mut theirs);
        Filter::of("OCTAHEDRAL", 4).unwrap().apply(&mut ours);
        for (a, b) in ours.iter().zip(theirs.as_flattened()) {
            assert!(near((*a as i8).into(), (*b).into()), "{a} {b}");
        }
        let shorts = |name: &str, encoded: &[[i16; 4]], theirs: &[[i16; 4]]| {
            let mut ours: Vec<u8> = encoded.as_flattened().iter().flat_map(|v| v.to_le_bytes()).collect();
            Filter::of(name, 8).unwrap().apply(&mut ours);
            for (a, b) in ours.as_chunks::<2>().0.iter().zip(theirs.as_flattened()) {
                let a = i16::from_le_bytes(*a);
                assert!(near(a.into(), (*b).into()), "{name}: {a} {b}");
            }
        };
        let encoded: Vec<[i16; 4]> = meshopt::encode_filter_oct(&vectors, 12);
        let mut theirs = encoded.clone();
        meshopt::decode_filter_oct(&mut theirs);
        shorts("OCTAHEDRAL", &encoded, &theirs);
        let quaternions: Vec<[f32; 4]> = noise(500).iter().map(|v| unit(*v, 4)).collect();
        let encoded = meshopt::encode_filter_quat(&quaternions, 13);
        let mut theirs = encoded.clone();
        meshopt::decode_filter_quat(&mut theirs);
        shorts("QUATERNION", &encoded, &theirs);
        let encoded = meshopt::encode_filter_exp(&noise(500), 17, meshopt::EncodeExpMode::Separate);
        let mut theirs = encoded.clone();
        meshopt::decode_filter_exp(&mut theirs);
        let mut ours: Vec<u8> = encoded.as_flattened().iter().flat_map(|v| v.to_le_bytes()).collect();
        Filter::of("EXPONENTIAL", 16).unwrap().apply(&mut ours);
        let theirs: Vec<u8> = theirs.as_flattened().iter().flat_map(|v| v.to_le_bytes()).collect();
        assert_eq!(ours, theirs);
    }

    /// Protects vertex colours at eight and at sixteen bits.
    #[test]
    fn colours_agree_with_meshoptimizer() {
        let colors: Vec<[f32; 4]> = noise(500).iter().map(|v| v.map(f32::abs)).collect();
        let encoded: Vec<[u8; 4]> = meshopt::encode_filter_color(&colors, 8);
        let mut theirs = encoded.clone();
        meshopt::decode_filter_color(&mut theirs);
        let mut ours = encoded.as_flattened().to_vec();
        Filter::of("COLOR", 4).unwrap().apply(&mut ours);
        for ((a, b), wanted) in ours.iter().zip(theirs.as_flattened()).zip(colors.as_flattened()) {
            assert!(a.abs_diff(*b) <= 1, "{a} {b}");
            assert!((f32::from(*a) / 255.0 - wanted).abs() < 0.02, "{a} {wanted}");
        }
        let encoded: Vec<[u16; 4]> = meshopt::encode_filter_color(&colors, 12);
        let mut theirs = encoded.clone();
        meshopt::decode_filter_color(&mut theirs);
        let mut ours: Vec<u8> = encoded.as_flattened().iter().flat_map(|v| v.to_le_bytes()).collect();
        Filter::of("COLOR", 8).unwrap().apply(&mut ours);
        for (a, b) in ours.as_chunks::<2>().0.iter().zip(theirs.as_flattened()) {
            assert!(u16::from_le_bytes(*a).abs_diff(*b) <= 1, "{a:?} {b}");
        }
    }

    /// Protects the reader from vectors without a direction and from alphas without a marker.
    #[test]
    fn degenerate_elements_are_numbers() {
        let mut zeros = vec![0u8; 16];
        for (name, stride) in [
            ("OCTAHEDRAL", 4),
            ("OCTAHEDRAL", 8),
            ("QUATERNION", 8),
            ("EXPONENTIAL", 4),
            ("COLOR", 4),
            ("COLOR", 8),
        ] {
            zeros.fill(0);
            Filter::of(name, stride).unwrap().apply(&mut zeros);
            zeros.fill(0x80);
            Filter::of(name, stride).unwrap().apply(&mut zeros);
            zeros.fill(0xff);
            Filter::of(name, stride).unwrap().apply(&mut zeros);
        }
        assert_eq!(Filter::of("OCTAHEDRAL", 12), None);
        assert_eq!(Filter::of("EXPONENTIAL", 6), None);
    }
}
