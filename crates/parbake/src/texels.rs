//! Numbers of texels as people write them: `512`, or `1k` for 1024.
//!
//! Contract: command line and options files take the same spellings.

use serde::de::{Deserialize, Deserializer, Error};

/// Reads a number of texels: `512`, or `1k`, `2k`, `4k` and `8k` for multiples of 1024.
///
/// # Errors
/// A sentence that says what a number of texels looks like.
pub fn parse_texels(text: &str) -> Result<usize, String> {
    let (digits, unit) = match text.strip_suffix(['k', 'K']) {
        Some(digits) => (digits, 1024),
        None => (text, 1),
    };
    digits
        .parse()
        .ok()
        .and_then(|number: usize| number.checked_mul(unit))
        .ok_or_else(|| "give a whole number of texels, such as 512, or 1k, 2k, 4k or 8k".into())
}

#[derive(serde::Deserialize)]
#[serde(untagged)]
enum Texels {
    Number(usize),
    Text(String),
}

impl Texels {
    fn count<E: Error>(self) -> Result<usize, E> {
        match self {
            Texels::Number(number) => Ok(number),
            Texels::Text(text) => parse_texels(&text).map_err(E::custom),
        }
    }
}

/// A field of texels: a number, or a text that [`parse_texels`] reads.
pub(crate) fn texels<'de, D: Deserializer<'de>>(deserializer: D) -> Result<usize, D::Error> {
    Texels::deserialize(deserializer)?.count()
}

/// The same, or nothing.
pub(crate) fn some_texels<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Option<usize>, D::Error> {
    Option::<Texels>::deserialize(deserializer)?.map(Texels::count).transpose()
}

#[cfg(test)]
mod tests {
    use super::parse_texels;
    use crate::BakeOptions;

    /// Protects who writes sizes as texture artists do, typed or in an options file.
    #[test]
    fn sizes_have_two_spellings() {
        assert_eq!((parse_texels("512"), parse_texels("2k")), (Ok(512), Ok(2048)));
        assert!(["", "k", "1.5k", "-1", "99999999999999999999k"].iter().all(|t| parse_texels(t).is_err()));
        let read = |json: &str| serde_json::from_str::<BakeOptions>(json);
        let options = read(r#"{"texture_size": "1k", "parallax_size": "32", "cutout_size": 64}"#).unwrap();
        assert_eq!((options.texture_size, options.parallax_size, options.cutout_size), (1024, 32, 64));
        assert!(read(r#"{"texture_size": "big"}"#).is_err() && read(r#"{"texture_size": -1}"#).is_err());
    }
}
