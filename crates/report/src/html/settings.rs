//! The settings on the page, read from the options' own serialisation, so that no
//! option can be forgotten.

use crate::page::text::escape;
use parbake::{BakeOptions, UsedValues, Work, idle_options};
use serde::Serialize;
use serde_json::Value;
use std::collections::BTreeMap;
use std::fmt::Write;

/// Options by name. Through text and back: a number becomes what a person would
/// have typed, 0.05 and not 0.05000000074505806.
fn fields(options: &impl Serialize) -> BTreeMap<String, Value> {
    serde_json::to_string(options).and_then(|text| serde_json::from_str(&text)).unwrap_or_default()
}

fn plain(value: &Value) -> String {
    match value {
        Value::String(text) => text.clone(),
        Value::Null => "none".into(),
        Value::Bool(on) => if *on { "yes" } else { "no" }.into(),
        Value::Number(n) => match n.as_f64() {
            // "1", not "1.0".
            Some(x) if n.is_f64() && x == x.trunc() && x.abs() < 1e9 => format!("{x:.0}"),
            _ => n.to_string(),
        },
        other => other.to_string(),
    }
}

/// What to type after a command to get these options, escaped.
pub fn flags<T: Serialize>(options: &T, default: &T) -> String {
    let default = fields(default);
    let mut out = String::new();
    for (name, value) in fields(options) {
        if default.get(&name) != Some(&value) {
            let _ = write!(out, " --{}", name.replace('_', "-"));
            if !value.is_boolean() {
                let _ = write!(out, " {}", plain(&value));
            }
        }
    }
    escape(&out)
}

/// "24 of at most 30", or the number alone where it was reached.
fn of_at_most(used: Option<usize>, most: usize) -> String {
    match used {
        Some(used) if used != most => format!("{used} of at most {most}"),
        _ => most.to_string(),
    }
}

/// The table of the options that act, with the values that were used, and the command that takes them.
pub fn settings(options: &BakeOptions, work: Work, used: &UsedValues) -> String {
    let (plan, default) = (options.plan(), fields(&BakeOptions::default()));
    let mut out = String::from(r#"<table class="settings"><tbody>"#);
    let idle = idle_options(options, work);
    let acts = |name: &str, value: &Value| {
        let is_empty = value.as_array().is_some_and(Vec::is_empty);
        !is_empty && !idle.iter().any(|(own, _)| *own == name)
    };
    for (name, value) in fields(options).into_iter().filter(|(name, value)| acts(name, value)) {
        let settled = match name.as_str() {
            "views" | "view_size" | "rounds" if used.views.is_none() => Some("not used".into()),
            "views" => Some(of_at_most(used.views, plan.views)),
            "view_size" => Some(plan.reference.size.to_string()),
            "rounds" => Some(plan.schedule.rounds.to_string()),
            "gutter" => Some(match used.gutter {
                Some(gutter) => format!("{} texels", plain(&gutter.into())),
                None => "as delivered".into(),
            }),
            "silhouette" => Some(options.silhouette_weight().to_string()),
            "robust_scale" => Some(plan.schedule.robust_scale.to_string()),
            "more_triangles" => Some(of_at_most(used.more_triangles, options.more_triangles())),
            "uv_steps" => Some(of_at_most(used.uv_steps.or(Some(0)), options.settled_uv_steps(work))),
            "fallback_size" => match used.fallback_size {
                Some(0) => Some("none: the maps' own textures serve all viewers".into()),
                side => side.map(|side| format!("{side} texels")),
            },
            "threads" if options.threads == 0 => Some("one a core".into()),
            _ => None,
        };
        let changed = default.get(&name).filter(|d| **d != value);
        let note = match changed {
            Some(Value::Null) if settled.is_some() => " <small>by default as the preset says</small>".into(),
            Some(d) => format!(" <small>by default {}</small>", escape(&plain(d))),
            None => String::new(),
        };
        let text = match (&value, settled) {
            (Value::Null, Some(settled)) => format!("{} <small>by default</small>", escape(&settled)),
            (_, Some(settled)) => escape(&settled),
            (value, None) => escape(&plain(value)),
        };
        let _ = write!(
            out,
            "<tr{}><th scope=\"row\">{}</th><td>{text}{note}</td></tr>",
            if changed.is_some() { r#" class="changed""# } else { "" },
            escape(&name.replace('_', " "))
        );
    }
    let _ = write!(
        out,
        "</tbody></table><p class=\"note\">To bake like this again: <code>parbake {}{}</code></p>",
        work.command(),
        flags(options, &BakeOptions::default())
    );
    out
}

#[cfg(test)]
mod tests {
    use super::*;
    use parbake::{Parallax, Preset};

    /// Protects the command line that the page offers.
    #[test]
    fn flags_are_what_was_asked() {
        let options = BakeOptions {
            preset: Preset::Fast,
            keep_normals: true,
            max_distance: 0.1,
            time_budget: Some(2.0),
            ..BakeOptions::default()
        };
        let default = BakeOptions::default();
        assert_eq!(
            flags(&options, &default),
            " --keep-normals --max-distance 0.1 --preset fast --time-budget 2"
        );
        assert_eq!(flags(&default, &default), "");
    }

    /// Protects the promise that every option that acts is on the page, and no other one.
    #[test]
    fn no_option_is_missing() {
        let options = BakeOptions {
            parallax: Parallax::Sh,
            keep_parts: vec!["wheel".into()],
            ..BakeOptions::default()
        };
        let views = options.plan().views;
        let used = UsedValues { views: Some(views), ..UsedValues::default() };
        let html = settings(&options, Work::Bake, &used);
        let idle = ["more_triangles", "no_content_aware", "importance"];
        let acting = fields(&options).into_keys().filter(|name| !idle.contains(&name.as_str()));
        for name in acting {
            assert!(
                html.contains(&format!("<th scope=\"row\">{}</th>", name.replace('_', " "))),
                "{name}: {html}"
            );
        }
        assert_eq!(html.matches("<tr").count(), fields(&options).len() - idle.len());
        let plain = settings(&BakeOptions::default(), Work::Compress, &UsedValues::default());
        // Without views their size says nothing.
        assert!(plain.contains("not used") && !html.contains("not used"));
        assert!(!plain.contains("cutout") && !plain.contains(">shape<") && plain.contains("more triangles"));
        assert!(
            html.contains(&format!("{views} <small>by default")) && html.contains("<td>0.05</td>"),
            "{html}"
        );
    }

    /// Protects readers from values that were only allowed: what a run used is on the page.
    #[test]
    fn values_are_those_that_were_used() {
        let used = UsedValues {
            views: Some(284),
            gutter: Some(16.0),
            uv_steps: Some(24),
            more_triangles: Some(0),
            fallback_size: Some(64),
            ..UsedValues::default()
        };
        let deep = BakeOptions { parallax: Parallax::Tangent, ..BakeOptions::default() };
        let (baked, compressed) =
            (settings(&deep, Work::Bake, &used), settings(&BakeOptions::default(), Work::Compress, &used));
        for text in ["284 of at most 960", "16 texels", "24 of at most 30", "64 texels"] {
            assert!(baked.contains(text), "{text}: {baked}");
        }
        assert!(compressed.contains("0 of at most 2000"), "{compressed}");
    }
}
