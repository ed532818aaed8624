//! JSON outputs of real runs against the committed schema, `docs/report.schema.json`.

use crate::common::{PLAIN, SMALL, demo_pair, json, run};
use serde_json::Value;
use std::path::Path;

/// What is wrong with a value by a schema; empty where nothing is. Knows the keywords that the committed
/// schema uses, and fails on any other, so that none is passed over.
fn faults(value: &Value, schema: &Value, root: &Value, at: &str) -> Vec<String> {
    let mut found = Vec::new();
    let of = |schema: &Value| faults(value, schema, root, at);
    for (keyword, rule) in schema.as_object().unwrap() {
        let is_wrong = match keyword.as_str() {
            "$schema" | "$id" | "$defs" | "title" | "description" => false,
            "$ref" => {
                let target = rule.as_str().unwrap().trim_start_matches('#');
                found.extend(of(root.pointer(target).unwrap()));
                false
            }
            "type" => match rule.as_str().unwrap() {
                "object" => !value.is_object(),
                "array" => !value.is_array(),
                "string" => !value.is_string(),
                "boolean" => !value.is_boolean(),
                "null" => !value.is_null(),
                "integer" => !(value.is_u64() || value.is_i64()),
                "number" => !value.is_number(),
                other => panic!("type {other}"),
            },
            "const" => value != rule,
            "enum" => !rule.as_array().unwrap().contains(value),
            "anyOf" => !rule.as_array().unwrap().iter().any(|one| of(one).is_empty()),
            "oneOf" => {
                let all: Vec<_> = rule.as_array().unwrap().iter().map(of).collect();
                let fits = all.iter().filter(|faults| faults.is_empty()).count();
                if fits == 0 {
                    // The nearest branch says most.
                    found.extend(all.into_iter().min_by_key(Vec::len).unwrap());
                }
                fits > 1
            }
            "required" => {
                let names = rule.as_array().unwrap().iter().map(|name| name.as_str().unwrap());
                let missing = names.filter(|name| value.get(name).is_none());
                found.extend(missing.map(|name| format!("{at}: {name} is missing")));
                false
            }
            "properties" => {
                for (name, rule) in rule.as_object().unwrap() {
                    let own = value.get(name);
                    found.extend(own.iter().flat_map(|own| faults(own, rule, root, &format!("{at}/{name}"))));
                }
                false
            }
            "additionalProperties" => {
                let known = &schema["properties"];
                let names = value.as_object().into_iter().flat_map(|object| object.keys());
                let unknown = names.filter(|name| known.get(name).is_none());
                found.extend(unknown.map(|name| format!("{at}: {name} is not in the schema")));
                false
            }
            "items" => {
                let items = value.as_array().into_iter().flatten().enumerate();
                found.extend(items.flat_map(|(i, own)| faults(own, rule, root, &format!("{at}/{i}"))));
                false
            }
            "minItems" => value.as_array().is_some_and(|a| (a.len() as u64) < rule.as_u64().unwrap()),
            "maxItems" => value.as_array().is_some_and(|a| (a.len() as u64) > rule.as_u64().unwrap()),
            other => panic!("keyword {other}"),
        };
        if is_wrong {
            found.push(format!("{at}: {keyword} {rule} does not hold for {value}"));
        }
    }
    found
}

/// Names in snake_case, all the way down.
fn assert_snake_case(value: &Value, at: &str) {
    for (name, value) in value.as_object().into_iter().flatten() {
        let plain = |c: char| c.is_ascii_lowercase() || c.is_ascii_digit() || c == '_';
        assert!(name.chars().all(plain), "{at}/{name}");
        assert_snake_case(value, &format!("{at}/{name}"));
    }
    value.as_array().into_iter().flatten().for_each(|value| assert_snake_case(value, at));
}

/// Protects scripts: every output keeps to the schema that is published, with one style of names.
#[test]
fn outputs_keep_to_the_schema() {
    let schema = json(&Path::new(env!("CARGO_MANIFEST_DIR")).join("../../docs/report.schema.json"));
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    demo_pair(folder);
    let simplify = ["simplify", "demo_high.glb", "-o", "few.glb", "--triangles", "300"];
    run(folder, &[&simplify[..], &["--closest-in", "shape", "-q"]].concat());
    let few = ["few.glb", "demo_low.glb"];
    let picture = parbake::Picture {
        name: "checks".into(),
        width: 32,
        height: 32,
        pixels: (0..1024u32).map(|i| [(i * 37 % 251) as u8, (i % 200) as u8, 90, 255]).collect(),
    };
    std::fs::write(folder.join("checks.png"), parbake::encode_png(&picture).unwrap()).unwrap();
    let pair = ["demo_high.glb", "demo_low.glb"];
    let small_file = ["--texture-format", "ktx2", "--mesh-compression", "meshopt"];
    let runs: [(&str, Vec<&str>); 11] = [
        ("bake", [&pair[..], &SMALL].concat()),
        ("bake", [&["few.glb", "--triangles", "200"], &SMALL[..], &PLAIN].concat()),
        ("bake", [&few[..], &SMALL, &PLAIN[..4], &["--parallax", "sh"]].concat()),
        ("bake", [&few[..], &SMALL, &PLAIN, &small_file].concat()),
        ("raycast", [&pair[..], &["--texture-size", "32", "--maps", "height,occlusion"]].concat()),
        (
            "compress",
            [&["few.glb", "--uv-steps", "2", "--gutter", "1", "--more-triangles", "0"], &SMALL[..8]].concat(),
        ),
        ("image", vec!["checks.png", "--texture-size", "16", "--grid", "8"]),
        ("eval", [&pair[..], &["--views", "2", "--resolution", "64"]].concat()),
        ("stats", pair[..1].to_vec()),
        ("check", vec!["demo_low.glb"]),
        ("stats", vec!["demo_low.glb", "--against", "demo_high.glb", "--samples", "1000"]),
    ];
    for (command, arguments) in runs {
        run(folder, &[&[command, "-q", "--json", "out.json"], &arguments[..]].concat());
        let out = json(&folder.join("out.json"));
        let wrong = faults(&out, &schema, &schema, "");
        assert!(wrong.is_empty(), "{command} {arguments:?}: {wrong:#?}");
        assert_snake_case(&out, command);
        assert_eq!((&out["command"], &out["version"]), (&command.into(), &3.into()));
    }
}

/// How many views the bake's summary compares.
fn compared_views(report: &serde_json::Value) -> String {
    report["comparison"]["options"]["views"].to_string()
}

/// Protects one figure everywhere: what a bake says of itself is what `eval` says of what it wrote.
#[test]
fn a_bake_and_eval_agree() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    demo_pair(folder);
    run(
        folder,
        &[&["bake", "demo_high.glb", "demo_low.glb", "-o", "a.glb", "--json", "a.json"], &SMALL[..]].concat(),
    );
    let report = json(&folder.join("a.json"));
    // As the bake's last line says: without further options.
    let views = compared_views(&report);
    let eval = ["eval", "demo_high.glb", "a.glb", "--views", &views, "--no-flip", "--json", "e.json"];
    run(folder, &eval);
    let own = report["comparison"]["backgrounds"][0]["mean"]["baked"]["psnr"].as_f64().unwrap();
    let evaluated = json(&folder.join("e.json"))["mean"]["psnr"].as_f64().unwrap();
    assert!((own - evaluated).abs() < 0.005, "{own} {evaluated}");
    assert_eq!(report["comparison"]["shading"], "lambert");
}

/// Protects the same of whole materials: metal is shown as metal by both, also by default, channel by channel; and
/// the schema of these outputs.
#[test]
fn a_bake_and_eval_agree_on_metal() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let (mut high, low) = parbake::demo_pair();
    for material in &mut high.materials {
        (material.metallic, material.roughness) = (1.0, 0.3);
    }
    for (name, model) in [("metal.glb", &high), ("low.glb", &low)] {
        parbake::write_glb(&folder.join(name), model).unwrap();
    }
    run(folder, &[&["bake", "metal.glb", "low.glb", "-o", "a.glb", "--json", "a.json"], &SMALL[..]].concat());
    let report = json(&folder.join("a.json"));
    let views = compared_views(&report);
    run(folder, &["eval", "metal.glb", "a.glb", "--views", &views, "--no-flip", "--json", "e.json"]);
    let evaluated = json(&folder.join("e.json"));
    let schema = json(&Path::new(env!("CARGO_MANIFEST_DIR")).join("../../docs/report.schema.json"));
    for out in [&report, &evaluated] {
        let wrong = faults(out, &schema, &schema, "");
        assert!(wrong.is_empty(), "{wrong:#?}");
        assert_snake_case(out, "metal");
    }
    let comparison = &report["comparison"];
    assert_eq!((&comparison["shading"], &evaluated["shading"]), (&"pbr".into(), &"pbr".into()));
    let own = comparison["backgrounds"][0]["mean"]["baked"]["psnr"].as_f64().unwrap();
    assert!((own - evaluated["mean"]["psnr"].as_f64().unwrap()).abs() < 0.005);
    let channels = |value: &Value| -> Vec<(String, f64)> {
        let one = |of: &Value| {
            let psnr = of["mean"].pointer("/baked/psnr").unwrap_or(&of["mean"]["psnr"]).as_f64().unwrap();
            (of["channel"].as_str().unwrap().to_string(), psnr)
        };
        value["channels"].as_array().unwrap().iter().map(one).collect()
    };
    let (own, evaluated) = (channels(comparison), channels(&evaluated));
    let names = ["base_color", "normal", "roughness", "metallic", "opacity"];
    assert_eq!(own.iter().map(|(name, _)| name.as_str()).collect::<Vec<_>>(), names);
    for ((name, own), (_, evaluated)) in own.iter().zip(&evaluated) {
        assert!((own - evaluated).abs() < 0.005, "{name} {own} {evaluated}");
    }
    // One value all over is kept.
    assert!(own[3].1 > 45.0, "{own:?}");
    // Under a headlight on matte surfaces the same files give another figure.
    let shown = |shading: &str| {
        let few = ["eval", "metal.glb", "a.glb", "--views", "2", "--resolution", "64", "--no-flip"];
        run(folder, &[&few[..], &["--shading", shading, "--json", "l.json"]].concat());
        json(&folder.join("l.json"))
    };
    let (lambert, pbr) = (shown("lambert"), shown("pbr"));
    assert!(lambert["channels"].as_array().unwrap().is_empty());
    assert_ne!(lambert["mean"]["psnr"], pbr["mean"]["psnr"]);
}
