//! Options that would do nothing are refused, typed or read from an options file.
//!
//! Contract: an option counts as asked for if it was typed, or if the options file gives it another value
//! than the default (a report holds all options, most of them at their defaults). The first rule that is
//! broken becomes one sentence that says what to do.

use crate::failure::Failure;
use clap::ArgMatches;
use clap::parser::ValueSource;
use parbake::{
    BakeOptions, EvaluateOptions, GeometryMap, ImageOptions, Match, Method, PictureUv, QUALITY_OF_LOSSLESS,
    RaycastOptions, RaycastUv, Work, WriteOptions, idle_options,
};
use serde_json::Value;
use std::path::Path;

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

/// The options that were typed which need views of the model, as they were typed.
pub fn typed_of_views(given: &ArgMatches) -> impl Iterator<Item = String> + '_ {
    // The convention says how colours are compared, whatever else there is. The robust loss stands with research.
    let of_views =
        WITH_MORE_THAN_COLOUR.iter().filter(|name| **name != "convention").chain(&["robust_scale"]);
    of_views.filter(|name| is_typed(given, name)).map(|name| typed_name(name))
}

/// Checks the options of the page of a running bake.
pub fn check_watch(is_watched: bool, given: &ArgMatches) -> Result<(), Failure> {
    let idle = ["port", "no_open"].into_iter().find(|name| !is_watched && is_typed(given, name));
    idle.map_or(Ok(()), |name| {
        Err(Failure::Usage(format!(
            "{} does nothing without --watch; add that or leave it out",
            typed_name(name)
        )))
    })
}

/// Checks the options of `bake` or `compress`; `file` is the options file, if there was one.
pub fn check(
    work: Work,
    options: &BakeOptions,
    given: &ArgMatches,
    file: Option<&Path>,
) -> Result<(), Failure> {
    let fields = |options: &BakeOptions| serde_json::to_value(options).unwrap_or(Value::Null);
    let (own, default) = (fields(options), fields(&BakeOptions::default()));
    let is_asked = |name: &str| is_typed(given, name) || (file.is_some() && own[name] != default[name]);
    let refuse = |name: &str, why: &str| {
        let source = match file {
            Some(file) if !is_typed(given, name) => format!("{}: ", file.display()),
            _ => String::new(),
        };
        Err(Failure::Usage(format!("{source}{} {why}", typed_name(name))))
    };
    if let Some((name, why)) = idle_options(options, work).into_iter().find(|(name, _)| is_asked(name)) {
        return refuse(name, why);
    }
    let makes_low_poly = is_typed(given, "triangles");
    match work == Work::Bake && !makes_low_poly && is_asked("keep_parts") {
        false => Ok(()),
        true => refuse(
            "keep_parts",
            "acts where the low-poly is made from the high-poly; give --triangles instead of LOW, or leave it out",
        ),
    }
}

/// Options of a bake that do nothing in `demo`, whose models have no nodes and no colours of vertices.
pub const IDLE_IN_DEMO: [&str; 2] = ["keep_parts", "importance_attribute"];

/// Checks the options of `demo`.
pub fn check_demo(options: &BakeOptions, given: &ArgMatches) -> Result<(), Failure> {
    for name in IDLE_IN_DEMO {
        refuse_typed(given, name, "does nothing in demo; leave it out")?;
    }
    check(Work::Bake, options, given, None)
}

/// Refuses an option that was typed.
fn refuse_typed(given: &ArgMatches, name: &str, why: &str) -> Result<(), Failure> {
    match is_typed(given, name) {
        false => Ok(()),
        true => Err(Failure::Usage(format!("{} {why}", typed_name(name)))),
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
    if options.uv == RaycastUv::Keep {
        refuse("gutter", "does nothing with --uv keep, which leaves charts where they are; leave it out")?;
    }
    check_quality(&options.write, given)
}

/// Refuses a quality of textures that lose nothing.
pub fn check_quality(formats: &WriteOptions, given: &ArgMatches) -> Result<(), Failure> {
    match formats.texture_format.is_lossless() {
        true => refuse_typed(given, "texture_quality", QUALITY_OF_LOSSLESS),
        false => Ok(()),
    }
}

/// Checks the options of `stats`.
pub fn check_stats(has_other: bool, given: &ArgMatches) -> Result<(), Failure> {
    match has_other {
        true => Ok(()),
        false => refuse_typed(given, "samples", "does nothing without --against; add that or leave it out"),
    }
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
