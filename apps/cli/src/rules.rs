//! Options that would do nothing are refused, typed or read from an options file.
//!
//! Contract: an option counts as asked for if it was typed, or if the options file gives it another value
//! than the default (a report holds all options, most of them at their defaults). The first rule that is
//! broken becomes one sentence that says what to do.

use crate::failure::Failure;
use clap::ArgMatches;
use clap::parser::ValueSource;
use parbake::{
    BakeOptions, EvaluateOptions, GeometryMap, ImageOptions, LodOptions, Match, Method, Parallax, PictureUv,
    RaycastOptions, TextureFormat, UvMode, Work,
};
use serde_json::Value;
use std::path::Path;

/// Options of a bake that do nothing where a model's own texture is replaced: the surface stays.
pub const NOT_IN_COMPRESS: [&str; 15] = [
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

/// Options that act in `compress` only on models with more to their materials than colour, which are baked as a pair
/// is; colour alone is fitted without views.
pub const WITH_MORE_THAN_COLOUR: [&str; 7] =
    ["views", "view_size", "rounds", "convention", "keep_normals", "normal_y", "seed"];

/// Whether an argument was typed; false for one that the command does not have.
pub fn is_typed(given: &ArgMatches, name: &str) -> bool {
    given.ids().any(|id| id == name) && given.value_source(name) == Some(ValueSource::CommandLine)
}

/// An option as one types it.
fn typed_name(name: &str) -> String {
    format!("--{}", name.replace('_', "-"))
}

/// Those of [`WITH_MORE_THAN_COLOUR`] that were typed, as they were typed.
pub fn typed_of_views(given: &ArgMatches) -> impl Iterator<Item = String> + '_ {
    // The convention says how colours are compared, whatever else there is.
    let of_views = WITH_MORE_THAN_COLOUR.iter().filter(|name| **name != "convention");
    of_views.filter(|name| is_typed(given, name)).map(|name| typed_name(name))
}

/// Checks the options of `bake`, `demo` or `compress`; `file` is the options file, if there was one.
pub fn check(
    work: Work,
    options: &BakeOptions,
    given: &ArgMatches,
    file: Option<&Path>,
) -> Result<(), Failure> {
    let fields = |options: &BakeOptions| serde_json::to_value(options).unwrap_or(Value::Null);
    let (own, default) = (fields(options), fields(&BakeOptions::default()));
    let is_asked = |name: &str| is_typed(given, name) || (file.is_some() && own[name] != default[name]);
    let refuse = |names: &[&str], why: &str| match names.iter().find(|name| is_asked(name)) {
        None => Ok(()),
        Some(name) => {
            let source = match file {
                Some(file) if !is_typed(given, name) => format!("{}: ", file.display()),
                _ => String::new(),
            };
            Err(Failure::Usage(format!("{source}{} {why}", typed_name(name))))
        }
    };
    if work == Work::Compress {
        refuse(&NOT_IN_COMPRESS, "does nothing in compress, which keeps the surface; leave it out")?;
        if options.uv != UvMode::Optimize && options.method != Method::Paper {
            refuse(&["more_triangles"], "does nothing without --uv optimize; choose that or leave it out")?;
        }
    } else {
        refuse(&["more_triangles"], "acts in compress only; leave it out")?;
    }
    if work == Work::Bake && !is_typed(given, "triangles") {
        let why = "acts where the low-poly is made of the high-poly's nodes; give --triangles instead of LOW, or leave \
                   it out";
        refuse(&["keep_parts"], why)?;
    }
    if options.parallax == Parallax::None {
        let of_map = ["parallax_order", "parallax_size", "fallback_size"];
        let maps = [&of_map[..], &["no_cutout", "cutout_order", "cutout_size"]].concat();
        refuse(&maps, "does nothing without --parallax; add --parallax tangent or leave it out")?;
    }
    if options.parallax == Parallax::Tangent {
        let why = "is of spherical harmonics, and does nothing with --parallax tangent; leave it out";
        refuse(&["parallax_order", "cutout_order"], why)?;
    }
    let of_cutout = ["cutout_order", "cutout_size"];
    if options.no_cutout {
        refuse(&of_cutout, "does nothing with --no-cutout; leave one of the two out")?;
    }
    if options.method == Method::Paper {
        refuse(&of_cutout, "does nothing with --method paper, which fits no cutout; leave it out")?;
        let why = "does nothing with --method paper, whose textures serve all viewers; leave it out";
        refuse(&["fallback_size"], why)?;
    } else {
        refuse(&["no_content_aware"], "does nothing without --method paper; add that or leave it out")?;
        if options.uv != UvMode::Optimize {
            refuse(&["uv_steps"], "does nothing without --uv optimize; choose that or leave it out")?;
        }
    }
    if options.rounds == Some(0) {
        let of_fit = ["keep_normals", "robust_scale"];
        refuse(&of_fit, "does nothing with --rounds 0, which fits no textures; leave one of the two out")?;
    }
    let is_lossless = is_lossless(options.write.texture_format);
    // Textures for viewers without parallax maps are JPEG in either case.
    if is_lossless && !options.has_fallback() {
        refuse(&["texture_quality"], QUALITY_OF_LOSSLESS)?;
    }
    if options.silhouette_weight() == 0.0 {
        refuse(
            &["silhouette_background"],
            "does nothing where --silhouette is 0, its default with a cutout; give --silhouette as well",
        )?;
    }
    Ok(())
}

const QUALITY_OF_LOSSLESS: &str =
    "does nothing with a lossless --texture-format; choose another or leave it out";

fn is_lossless(format: TextureFormat) -> bool {
    matches!(format, TextureFormat::Png | TextureFormat::WebpLossless)
}

/// Refuses an option that was typed.
fn refuse_typed(given: &ArgMatches, name: &str, why: &str) -> Result<(), Failure> {
    match is_typed(given, name) {
        false => Ok(()),
        true => Err(Failure::Usage(format!("{} {why}", typed_name(name)))),
    }
}

/// Checks the options of `lod`.
pub fn check_lod(options: &LodOptions, given: &ArgMatches) -> Result<(), Failure> {
    match is_lossless(options.write.texture_format) {
        true => refuse_typed(given, "texture_quality", QUALITY_OF_LOSSLESS),
        false => Ok(()),
    }
}

/// Checks the options of `eval`.
pub fn check_eval(options: &EvaluateOptions, given: &ArgMatches) -> Result<(), Failure> {
    match options.ortho {
        Some(_) => refuse_typed(
            given,
            "fov",
            "does nothing with --ortho, whose rays are parallel; leave one of the two out",
        ),
        None => Ok(()),
    }
}

/// Checks the options of `raycast`.
pub fn check_raycast(options: &RaycastOptions, given: &ArgMatches) -> Result<(), Failure> {
    let refuse = |name: &str, why: &str| refuse_typed(given, name, why);
    let has = |maps: &[GeometryMap]| maps.iter().any(|map| options.maps.contains(map));
    let sees_sky = has(&[GeometryMap::Occlusion, GeometryMap::BentNormal]) || options.occlusion_texture;
    if !sees_sky {
        refuse("occlusion_distance", "does nothing without --maps occlusion; add that or leave it out")?;
    }
    if !sees_sky && !has(&[GeometryMap::Thickness, GeometryMap::Curvature]) {
        refuse("rays", "does nothing without --maps occlusion or thickness; add that or leave it out")?;
    }
    if !has(&[GeometryMap::Curvature]) {
        refuse("curvature_radius", "does nothing without --maps curvature; add that or leave it out")?;
    }
    if options.r#match == Match::ClosestPoint {
        refuse("ray_normals", "does nothing with --match closest-point, which casts no rays; leave it out")?;
    }
    if is_lossless(options.write.texture_format) {
        refuse("texture_quality", QUALITY_OF_LOSSLESS)?;
    }
    Ok(())
}

/// Checks the options of `image`.
pub fn check_image(options: &ImageOptions, given: &ArgMatches) -> Result<(), Failure> {
    let refuse = |names: &[&str], why: &str| match names.iter().find(|name| is_typed(given, name)) {
        None => Ok(()),
        Some(name) => Err(Failure::Usage(format!("{} {why}", typed_name(name)))),
    };
    if options.uv == PictureUv::Keep {
        let moves = ["steps", "method", "no_content_aware", "animation"];
        refuse(&moves, "does nothing with --uv keep; choose --uv optimize or leave it out")?;
    }
    if options.method != Method::Paper {
        refuse(&["no_content_aware"], "does nothing without --method paper; add that or leave it out")?;
    }
    Ok(())
}
