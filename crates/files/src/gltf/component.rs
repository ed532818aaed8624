//! The types of the numbers in accessors (glTF 2.0, 3.6.2.2) and in Draco streams.
//!
//! Contract: numbers are little-endian; those of signed and unsigned integers become floats without loss but for 32
//! bits.

/// A component's type.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Component {
    I8,
    U8,
    I16,
    U16,
    U32,
    F32,
}

impl Component {
    /// The type that a document has this code for.
    pub fn of(code: usize) -> Option<Self> {
        Some(match code {
            5120 => Self::I8,
            5121 => Self::U8,
            5122 => Self::I16,
            5123 => Self::U16,
            5125 => Self::U32,
            5126 => Self::F32,
            _ => return None,
        })
    }

    /// Bytes of a number.
    pub fn size(self) -> usize {
        match self {
            Self::I8 | Self::U8 => 1,
            Self::I16 | Self::U16 => 2,
            Self::U32 | Self::F32 => 4,
        }
    }

    /// The number at `at`; 0 beyond the end, which the checks have ruled out.
    pub fn read(self, bytes: &[u8], at: usize) -> f32 {
        fn array<const N: usize>(bytes: &[u8], at: usize) -> [u8; N] {
            bytes.get(at..).and_then(|b| b.first_chunk()).copied().unwrap_or([0; N])
        }
        match self {
            Self::I8 => f32::from(i8::from_le_bytes(array(bytes, at))),
            Self::U8 => f32::from(u8::from_le_bytes(array(bytes, at))),
            Self::I16 => f32::from(i16::from_le_bytes(array(bytes, at))),
            Self::U16 => f32::from(u16::from_le_bytes(array(bytes, at))),
            Self::U32 => u32::from_le_bytes(array(bytes, at)) as f32,
            Self::F32 => f32::from_le_bytes(array(bytes, at)),
        }
    }

    /// The unsigned integer at `at`; 0 beyond the end.
    pub fn read_index(self, bytes: &[u8], at: usize) -> u32 {
        match self {
            Self::U32 => bytes.get(at..).and_then(|b| b.first_chunk()).map_or(0, |b| u32::from_le_bytes(*b)),
            // Exact: these are at most 65535.
            other => other.read(bytes, at) as u32,
        }
    }

    /// From an integer to the fraction it stands for (glTF 2.0, 3.6.2.2).
    pub fn normalize(self, value: f32) -> f32 {
        match self {
            Self::I8 => (value / 127.0).max(-1.0),
            Self::U8 => value / 255.0,
            Self::I16 => (value / 32767.0).max(-1.0),
            Self::U16 => value / 65535.0,
            Self::U32 => value / u32::MAX as f32,
            Self::F32 => value,
        }
    }
}
