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
