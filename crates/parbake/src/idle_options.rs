//! Options of a bake that do nothing beside the others: the command refuses them, the report leaves them out.
//!
//! Contract: each option is named as its field in [`BakeOptions`], with what to do about it. Options that depend on the
//! models, as those of plain materials do under [`Shading::Auto`], are not here: a bake tells of them.

use crate::options::{BakeOptions, Method, Parallax, Shading, UvMode};
use crate::work::Work;

/// Options of a bake that do nothing where a model's own texture is replaced: the surface stays.
pub const IDLE_IN_COMPRESS: [&str; 15] = [
    "shape",
    "silhouette_background",
    "silhouette",
    "parallax",
    "parallax_order",
    "parallax_size",
    "no_cutout",
    "cutout_order",
    "cutout_size",
    "fallback_size",
    "max_distance",
    "keep_sides",
    "importance",
    "importance_attribute",
    "keep_parts",
];

/// What is said of the quality of textures that lose nothing.
pub const QUALITY_OF_LOSSLESS: &str =
    "does nothing with a lossless --texture-format; choose another or leave it out";

/// The options that do nothing in this work beside the others, each with why and what to do instead: the end of a sentence
/// that begins with the option's name.
pub fn idle_options(options: &BakeOptions, work: Work) -> Vec<(&'static str, &'static str)> {
    let mut idle = Vec::new();
    let mut add = |is_idle: bool, names: &[&'static str], why: &'static str| {
        idle.extend(names.iter().filter(|_| is_idle).map(|name| (*name, why)));
    };
    let is_compress = work == Work::Compress;
    let is_paper = options.method == Method::Paper;
    let is_flat = options.parallax == Parallax::None;
    // The paper's method fits parallax maps of its own, to plain materials' pictures.
    let has_parallax = options.parallax_plan().is_some();

    let why = "does nothing in compress, which keeps the surface; leave it out";
    add(is_compress, &IDLE_IN_COMPRESS, why);
    let why = "does nothing without --uv optimize; choose that or leave it out";
    add(is_compress && options.uv != UvMode::Optimize && !is_paper, &["more_triangles"], why);
    add(!is_compress, &["more_triangles"], "acts in compress only; leave it out");
    add(!is_paper && options.uv != UvMode::Optimize, &["uv_steps"], why);
    let why = "does nothing with --uv keep, which leaves charts where they are; leave it out";
    add(options.uv == UvMode::Keep, &["gutter"], why);

    let why = "does nothing with --shading pbr; choose --shading lambert or leave it out";
    let is_whole = options.shading == Shading::Pbr;
    add(is_whole, &["robust_scale"], why);
    add(is_whole && !has_parallax, &["silhouette", "silhouette_background"], why);

    let of_map = ["parallax_order", "parallax_size", "fallback_size", "no_cutout"];
    let of_cutout = ["cutout_order", "cutout_size"];
    let why = "does nothing without --parallax; add --parallax tangent or leave it out";
    add(is_flat, &of_map, why);
    add(is_flat, &of_cutout, why);
    let why = "is of spherical harmonics, and does nothing with --parallax tangent; leave it out";
    add(options.parallax == Parallax::Tangent, &["parallax_order", "cutout_order"], why);
    add(options.no_cutout, &of_cutout, "does nothing with --no-cutout; leave one of the two out");
    let why = "does nothing with --method paper, which fits no cutout; leave it out";
    add(is_paper, &of_cutout, why);
    let why = "does nothing with --method paper, whose textures serve all viewers; leave it out";
    add(is_paper, &["fallback_size"], why);
    let why = "does nothing without --method paper; add that or leave it out";
    add(!is_paper, &["no_content_aware"], why);
    let why = "does nothing with --rounds 0, which fits no textures; leave one of the two out";
    add(options.rounds == Some(0), &["keep_normals", "robust_scale"], why);

    // Textures for viewers without parallax maps are JPEG in either case.
    let is_exact = options.write.texture_format.is_lossless() && !options.has_fallback();
    add(is_exact, &["texture_quality"], QUALITY_OF_LOSSLESS);
    let why = match options.silhouette {
        Some(_) => "does nothing with --silhouette 0; leave one of the two out",
        None => "does nothing with a cutout, unless --silhouette is given as well",
    };
    // The textures of viewers without parallax maps are those of a bake without a cutout.
    let has_outline = options.silhouette.is_none() && options.has_fallback() && !is_whole;
    add(options.silhouette_weight() == 0.0 && !has_outline, &["silhouette_background"], why);
    idle
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;
    use serde_json::Value;

    /// Protects reports and refusals from names that no option has, and default bakes from refusals.
    #[test]
    fn names_are_those_of_options() {
        let Value::Object(fields) = serde_json::to_value(BakeOptions::default()).unwrap() else { panic!() };
        let paper = BakeOptions {
            method: Method::Paper,
            rounds: Some(0),
            uv: UvMode::Keep,
            silhouette: Some(0.0),
            ..BakeOptions::default()
        };
        let tangent = BakeOptions {
            parallax: Parallax::Tangent,
            shading: Shading::Pbr,
            no_cutout: true,
            ..paper.clone()
        };
        for options in [BakeOptions::default(), paper, tangent] {
            for work in [Work::Bake, Work::Level, Work::Compress] {
                for (name, why) in idle_options(&options, work) {
                    assert!(fields.contains_key(name), "{name}");
                    assert!(!why.is_empty());
                }
            }
        }
    }

    /// Protects people's options: what acts is not called idle.
    #[test]
    fn what_acts_is_not_idle() {
        let is_idle = |options: &BakeOptions, name: &str| {
            idle_options(options, Work::Bake).iter().any(|(idle, _)| *idle == name)
        };
        let plain = BakeOptions::default();
        let whole = BakeOptions { shading: Shading::Pbr, ..plain.clone() };
        let deep = BakeOptions { parallax: Parallax::Tangent, silhouette: Some(0.5), ..whole.clone() };
        for name in ["shape", "uv_steps", "gutter", "robust_scale", "silhouette", "silhouette_background"] {
            assert!(!is_idle(&plain, name), "{name}");
        }
        assert!(is_idle(&whole, "silhouette") && is_idle(&whole, "robust_scale"));
        assert!(!is_idle(&deep, "silhouette") && !is_idle(&deep, "silhouette_background"));
        assert!(is_idle(&plain, "cutout_size") && !is_idle(&deep, "cutout_size"));
        let fallback = BakeOptions { parallax: Parallax::Tangent, ..plain.clone() };
        let own = BakeOptions { fallback_size: Some(0), ..fallback.clone() };
        assert!(!is_idle(&fallback, "silhouette_background") && is_idle(&own, "silhouette_background"));
    }
}
