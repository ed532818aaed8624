//! What is wrong with a layout, in sentences for people.

use super::{Found, UvCheck};

/// One sentence for each kind of problem; none exactly where the layout is sound.
pub(super) fn problems(check: &UvCheck) -> Vec<String> {
    let o = &check.orientations;
    let mut sentences = Vec::new();
    let mut say = |found: &Found, thing: &str, one: &str, many: &str| {
        if found.count > 0 {
            let what = if found.count == 1 { one } else { many };
            sentences.push(format!("{} {what}{}.", counted(found.count, thing), named(found)));
        }
    };
    say(
        &o.not_finite,
        "triangle",
        "has texture coordinates that are not finite",
        "have texture coordinates that are not finite",
    );
    say(&o.flipped, "triangle", "is flipped within its chart", "are flipped within their charts");
    say(&o.mirrored_charts, "chart", "is mirrored as a whole", "are mirrored as a whole");
    say(
        &o.degenerate,
        "triangle",
        "has an area in space but none in the texture",
        "have an area in space but none in the texture",
    );
    say(&o.outside, "triangle", "leaves the texture", "leave the texture");
    let overlaps = &check.overlaps;
    if let Some(first) = overlaps.first.first() {
        let [a, b] = first.triangles;
        let [x, y] = first.place;
        let bound = if overlaps.complete { "" } else { "at least " };
        let pairs = overlaps.pairs;
        let (noun, verb) = if pairs == 1 { ("pair", "overlaps") } else { ("pairs", "overlap") };
        let start = if pairs == 1 { "they" } else { "the first" };
        sentences.push(format!(
            "{bound}{pairs} {noun} of triangles {verb}, {bound}{} texels in all; {start} are {a} and {b} near ({x:.4}, {y:.4}).",
            rounded(overlaps.texels)
        ));
    } else if !overlaps.complete {
        sentences.push(
            "too many triangles lie so close to each other that the search for overlaps was ended; none was found until then."
                .to_owned(),
        );
    }
    sentences.iter().map(|s| capitalised(s)).collect()
}

fn counted(count: usize, thing: &str) -> String {
    if count == 1 { format!("1 {thing}") } else { format!("{count} {thing}s") }
}

/// The indices, in brackets.
fn named(found: &Found) -> String {
    let indices: Vec<String> = found.first.iter().map(u32::to_string).collect();
    let more = if found.count > indices.len() { ", …" } else { "" };
    format!(" ({}{more})", indices.join(", "))
}

/// With about two digits that count.
fn rounded(value: f64) -> String {
    if value == 0.0 || value >= 0.1 { format!("{value:.1}") } else { format!("{value:.1e}") }
}

fn capitalised(sentence: &str) -> String {
    let mut letters = sentence.chars();
    letters.next().map_or_else(String::new, |first| first.to_uppercase().chain(letters).collect())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Layout;
    use crate::check::{FIRST, Overlap, Overlaps};

    fn clean() -> UvCheck {
        crate::check::check(&Layout::default(), 64)
    }

    fn found(count: usize) -> Found {
        Found { count, first: (0..count.min(FIRST) as u32).map(|i| 3 * i).collect() }
    }

    /// Protects the sentence of each kind of fault, in the singular and the plural, and
    /// their order; and that each of them makes a layout unsound.
    #[test]
    fn every_fault_has_its_sentence() {
        type Place = fn(&mut UvCheck) -> &mut Found;
        let kinds: [(Place, &str, &str); 5] = [
            (
                |c| &mut c.orientations.not_finite,
                "1 triangle has texture coordinates that are not finite (0).",
                "2 triangles have texture coordinates that are not finite (0, 3).",
            ),
            (
                |c| &mut c.orientations.flipped,
                "1 triangle is flipped within its chart (0).",
                "2 triangles are flipped within their charts (0, 3).",
            ),
            (
                |c| &mut c.orientations.mirrored_charts,
                "1 chart is mirrored as a whole (0).",
                "2 charts are mirrored as a whole (0, 3).",
            ),
            (
                |c| &mut c.orientations.degenerate,
                "1 triangle has an area in space but none in the texture (0).",
                "2 triangles have an area in space but none in the texture (0, 3).",
            ),
            (
                |c| &mut c.orientations.outside,
                "1 triangle leaves the texture (0).",
                "2 triangles leave the texture (0, 3).",
            ),
        ];
        assert!(problems(&clean()).is_empty() && clean().is_bijective());
        let mut all = clean();
        for (place, one, two) in kinds {
            let mut check = clean();
            for (count, sentence) in [(1, one), (2, two)] {
                *place(&mut check) = found(count);
                assert_eq!(problems(&check), [sentence]);
                assert!(!check.is_bijective());
            }
            *place(&mut all) = found(1);
        }
        assert_eq!(problems(&all), kinds.map(|k| k.1));
    }

    /// Protects the indices: all of them, or the first ones and a sign that there are more.
    #[test]
    fn what_is_left_out_is_marked() {
        let mut check = clean();
        check.orientations.outside = found(5);
        assert_eq!(problems(&check), ["5 triangles leave the texture (0, 3, 6, 9, 12)."]);
        check.orientations.outside = found(6);
        assert_eq!(problems(&check), ["6 triangles leave the texture (0, 3, 6, 9, 12, …)."]);
    }

    /// Protects the sentence of overlaps: one, several, not all, and none found in time.
    #[test]
    fn overlaps_have_their_sentences() {
        let overlap = Overlap { triangles: [3, 14], place: [0.25, 0.12345], texels: 7.0 };
        let overlaps = |pairs: usize, complete: bool, texels: f64| {
            let first = vec![overlap.clone(); pairs.min(FIRST)];
            let check = UvCheck {
                overlaps: Overlaps { pairs, complete, area: texels / 4096.0, texels, first },
                ..clean()
            };
            assert_eq!(check.is_bijective(), check.problems().is_empty());
            problems(&check)
        };
        assert_eq!(
            overlaps(1, true, 7.0),
            ["1 pair of triangles overlaps, 7.0 texels in all; they are 3 and 14 near (0.2500, 0.1235)."]
        );
        assert_eq!(
            overlaps(2, true, 0.0),
            [
                "2 pairs of triangles overlap, 0.0 texels in all; the first are 3 and 14 near (0.2500, 0.1235)."
            ]
        );
        assert_eq!(
            overlaps(2, false, 0.05),
            [
                "At least 2 pairs of triangles overlap, at least 5.0e-2 texels in all; the first are 3 and 14 near (0.2500, 0.1235)."
            ]
        );
        assert_eq!(
            overlaps(0, false, 0.0),
            [
                "Too many triangles lie so close to each other that the search for overlaps was ended; none was found until then."
            ]
        );
        assert!(overlaps(0, true, 0.0).is_empty());
    }

    /// Protects the digits that count.
    #[test]
    fn small_areas_keep_two_digits() {
        assert_eq!(
            [0.0, 0.1, 12.34, 0.0999, 1.26e-9].map(rounded),
            ["0.0", "0.1", "12.3", "1.0e-1", "1.3e-9"]
        );
    }

    /// Protects the first letter, of a sentence without letters as well.
    #[test]
    fn sentences_begin_with_a_capital() {
        assert_eq!(["ärger", "2 pairs", ""].map(capitalised), ["Ärger", "2 pairs", ""]);
    }
}
