//! Material libraries (.mtl): `newmtl`, `Kd`, `d`, `Ke`, `Pr`, `Pm` and their maps, `norm`,
//! `map_Bump`.
//!
//! Follows the Wavefront "Material Library File" appendix, and `norm`, `Ke`, `Pr` and `Pm` from
//! the PBR extension to it. Keywords are taken in any case, as exporters write
//! `map_kd` and `map_Kd`; options may stand before or after the file name, and
//! the name may contain blanks. Nothing in a library is an error: a line that
//! makes no sense is passed over, as most programs do.

use super::lex::{Lines, Words, number, text};

/// A picture as a material names it.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Map {
    /// As written.
    pub file: String,
    /// `-s u v`: multiplies the coordinates.
    pub scale: [f32; 2],
    /// `-o u v`: added after that, v up.
    pub offset: [f32; 2],
    /// `-clamp on`.
    pub clamp: bool,
    /// `-bm`: how strong bumps are.
    pub strength: f32,
    /// `-imfchan`: the channel that a number is read from, as a small letter.
    pub channel: Option<u8>,
}

impl Default for Map {
    fn default() -> Self {
        let file = String::new();
        Self { file, scale: [1.0; 2], offset: [0.0; 2], clamp: false, strength: 1.0, channel: None }
    }
}

/// One `newmtl` section.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Section {
    pub name: Vec<u8>,
    pub diffuse: Option<[f64; 3]>,
    pub opacity: Option<f32>,
    pub diffuse_map: Option<Map>,
    pub normal_map: Option<Map>,
    pub bump_map: Option<Map>,
    pub has_opacity_map: bool,
    pub emission: Option<[f64; 3]>,
    pub emission_map: Option<Map>,
    pub roughness: Option<f32>,
    pub roughness_map: Option<Map>,
    pub metallic: Option<f32>,
    pub metallic_map: Option<Map>,
}

/// A section, and the folder of its library (empty, or with a `/` at the end).
pub(super) type Found = (Section, String);

/// All sections, in order.
pub(super) fn read(bytes: &[u8]) -> Vec<Section> {
    let mut sections: Vec<Section> = Vec::new();
    let mut lines = Lines::new(bytes);
    while let Some((_, line)) = lines.next() {
        let mut words = Words::new(line);
        let Some(keyword) = words.next() else { continue };
        let keyword = keyword.to_ascii_lowercase();
        if keyword == b"newmtl" {
            sections.push(Section { name: words.remainder().to_vec(), ..Section::default() });
            continue;
        }
        let Some(section) = sections.last_mut() else { continue };
        match keyword.as_slice() {
            b"kd" => section.diffuse = color(words, 1.0, 1.0).or(section.diffuse),
            // Not `Tr`: some programs write opacity there and some its opposite.
            b"d" => section.opacity = words.find_map(number).or(section.opacity),
            b"map_kd" => section.diffuse_map = map(words.remainder()),
            b"norm" | b"map_norm" => section.normal_map = map(words.remainder()),
            b"bump" | b"map_bump" => section.bump_map = map(words.remainder()),
            b"map_d" => section.has_opacity_map = true,
            b"ke" => section.emission = color(words, f64::MAX, 0.0).or(section.emission),
            b"map_ke" => section.emission_map = map(words.remainder()),
            b"pr" => section.roughness = words.find_map(number).or(section.roughness),
            b"map_pr" => section.roughness_map = map(words.remainder()),
            b"pm" => section.metallic = words.find_map(number).or(section.metallic),
            b"map_pm" => section.metallic_map = map(words.remainder()),
            _ => {}
        }
    }
    sections
}

/// `Kd r g b`, or `Kd grey`; not `Kd spectral …` nor `Kd xyz …`. From 0 to `most`; `otherwise`
/// where a number is not finite.
fn color(words: Words<'_>, most: f64, otherwise: f64) -> Option<[f64; 3]> {
    let mut values = words.map(number::<f64>);
    let r = values.next()??;
    let g = values.next().unwrap_or(Some(r))?;
    let b = values.next().unwrap_or(Some(r))?;
    Some([r, g, b].map(|x| if x.is_finite() { x.clamp(0.0, most) } else { otherwise }))
}

/// Options, and how many words follow them at least and at most.
const OPTIONS: [(&[u8], usize, usize); 15] = [
    (b"-blendu", 1, 1),
    (b"-blendv", 1, 1),
    (b"-boost", 1, 1),
    (b"-cc", 1, 1),
    (b"-clamp", 1, 1),
    (b"-imfchan", 1, 1),
    (b"-mm", 2, 2),
    (b"-o", 1, 3),
    (b"-s", 1, 3),
    (b"-t", 1, 3),
    (b"-texres", 1, 1),
    (b"-bm", 1, 1),
    (b"-type", 1, 1),
    (b"-colorspace", 1, 1),
    (b"-shaderspace", 1, 1),
];

/// Options and file name. `None` when there is no name.
fn map(rest: &[u8]) -> Option<Map> {
    let mut map = Map::default();
    // The name is what no option takes, from its first to its last word: the
    // blanks between them are part of it.
    let mut name: Option<(usize, usize)> = None;
    let mut words = spans(rest).peekable();
    while let Some((start, end)) = words.next() {
        let word = rest[start..end].to_ascii_lowercase();
        let Some(&(_, least, most)) = OPTIONS.iter().find(|(option, ..)| *option == word) else {
            name = Some((name.map_or(start, |n| n.0), end));
            continue;
        };
        let mut values = [None; 3];
        let mut flag: &[u8] = b"";
        for (i, value) in values.iter_mut().enumerate().take(most) {
            let Some(&(s, e)) = words.peek() else { break };
            *value = number::<f32>(&rest[s..e]).filter(|v| v.is_finite());
            if i >= least && value.is_none() {
                break;
            }
            flag = &rest[s..e];
            words.next();
        }
        match (word.as_slice(), values) {
            (b"-s", [Some(u), v, _]) => map.scale = [u, v.unwrap_or(1.0)],
            (b"-o", [Some(u), v, _]) => map.offset = [u, v.unwrap_or(0.0)],
            (b"-bm", [Some(strength), ..]) => map.strength = strength,
            (b"-imfchan", _) => map.channel = flag.first().map(u8::to_ascii_lowercase),
            (b"-clamp", _) => map.clamp = flag.eq_ignore_ascii_case(b"on"),
            _ => {}
        }
    }
    let (start, end) = name?;
    map.file = text(&rest[start..end]).trim_matches('"').replace('\\', "/");
    Some(map)
}

/// Where words begin and end. Unlike [`Words`], `#` begins no comment: names have it.
fn spans(line: &[u8]) -> impl Iterator<Item = (usize, usize)> {
    let mut at = 0;
    std::iter::from_fn(move || {
        let start = at + line[at..].iter().position(|b| !b.is_ascii_whitespace())?;
        let length = line[start..].iter().position(u8::is_ascii_whitespace);
        at = length.map_or(line.len(), |n| start + n);
        Some((start, at))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn parse(line: &str) -> Map {
        map(line.as_bytes()).unwrap()
    }

    /// Protects options before and after names with blanks.
    #[test]
    fn maps_with_options() {
        let plain = Map { file: "a b.png".into(), ..Map::default() };
        assert_eq!(parse("a b.png"), plain);
        assert_eq!(parse("-texres 512 -mm 0 1 -type sphere a b.png"), plain);
        assert_eq!(parse("-s 2 3 4 -o 0.5 -clamp on a b.png").scale, [2.0, 3.0]);
        assert_eq!(parse("-s 2 3 4 -o 0.5 -clamp on a b.png").offset, [0.5, 0.0]);
        let after = parse("-imfchan r a  b.png -bm 1.5");
        assert_eq!((after.file.as_str(), after.strength, after.channel), ("a  b.png", 1.5, Some(b'r')));
        assert!(parse("-clamp ON a").clamp && !parse("-clamp off a").clamp);
        assert_eq!(parse("tex\\wood#1.png").file, "tex/wood#1.png");
        assert_eq!(map(b"  -s 1 1 1"), None);
        assert_eq!(parse("-s 1 1 1 1.png").file, "1.png");
    }

    /// Protects keywords of any case, and what is said twice or not at all.
    #[test]
    fn sections() {
        let text = b"Kd 1 1 1\nnewmtl  a b\nKD .5 2 nan\nd 0.5\nmap_kd x.png\nbump y.png\nNorm z.png\nnewmtl c\nKd 0.25\nKd red";
        let sections = read(text);
        assert_eq!(sections.len(), 2);
        assert_eq!(sections[0].name, b"a b");
        assert_eq!(sections[0].diffuse, Some([0.5, 1.0, 1.0]));
        assert_eq!(sections[0].opacity, Some(0.5));
        assert_eq!(sections[0].normal_map.as_ref().unwrap().file, "z.png");
        assert_eq!(sections[0].bump_map.as_ref().unwrap().file, "y.png");
        assert_eq!(sections[1].diffuse, Some([0.25; 3]));
        assert_eq!(sections[1].diffuse_map, None);
    }
}
