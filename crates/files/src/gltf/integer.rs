//! Whole numbers of a glTF document: some exporters write `0.0` for `0`, and so
//! may everyone (glTF 2.0, section 2.3 leaves the notation open).

use serde::Deserialize;
use serde::de::{self, Deserializer, Visitor};
use std::fmt;

/// A whole number from 0, however it is written.
#[derive(Clone, Copy)]
struct Integer(usize);

impl<'de> Deserialize<'de> for Integer {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Digits;
        impl Visitor<'_> for Digits {
            type Value = Integer;

            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("a whole number from 0")
            }

            fn visit_u64<E: de::Error>(self, value: u64) -> Result<Integer, E> {
                usize::try_from(value).map(Integer).map_err(E::custom)
            }

            fn visit_i64<E: de::Error>(self, value: i64) -> Result<Integer, E> {
                Err(E::invalid_value(de::Unexpected::Signed(value), &self))
            }

            fn visit_f64<E: de::Error>(self, value: f64) -> Result<Integer, E> {
                // Beyond 2⁵³ doubles are no longer exact, and no count is that large.
                if (0.0..9e15).contains(&value) && value.fract() == 0.0 {
                    return self.visit_u64(value as u64);
                }
                Err(E::invalid_value(de::Unexpected::Float(value), &self))
            }
        }
        deserializer.deserialize_any(Digits)
    }
}

pub(super) fn integer<'de, D: Deserializer<'de>>(deserializer: D) -> Result<usize, D::Error> {
    Integer::deserialize(deserializer).map(|i| i.0)
}

pub(super) fn optional_integer<'de, D: Deserializer<'de>>(
    deserializer: D,
) -> Result<Option<usize>, D::Error> {
    Ok(Option::<Integer>::deserialize(deserializer)?.map(|i| i.0))
}

pub(super) fn integers<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Vec<usize>, D::Error> {
    Ok(Vec::<Integer>::deserialize(deserializer)?.into_iter().map(|i| i.0).collect())
}

#[cfg(test)]
mod tests {
    use super::super::json::Document;

    /// Protects documents whose numbers have a point, and the defaults.
    #[test]
    fn integers_may_have_a_point() {
        let text = r#"{"accessors":[{"componentType":5126.0,"count":3.0,"type":"VEC3"}],"scene":0.0,"nodes":[{"children":[1.0]}]}"#;
        let document: Document = serde_json::from_slice(text.as_bytes()).unwrap();
        assert_eq!(document.accessors[0].count, 3);
        assert_eq!((document.scene, document.nodes[0].children[0]), (Some(0), 1));
        for bad in ["-1", "1.5", "1e300", "\"1\""] {
            let text = format!("{{\"scene\":{bad}}}");
            assert!(serde_json::from_slice::<Document>(text.as_bytes()).is_err());
        }
    }
}
