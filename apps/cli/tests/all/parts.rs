//! Nodes that stay apart through whole commands (`--keep-parts`).

use crate::common::{json, parbake, run, text};
use parbake::{Limits, Model, read_model, write_glb};
use parbake_model::glam::{DQuat, DVec3, Vec3};
use parbake_model::{Hierarchy, Material, Mesh, Node, NodeTransform};
use std::fs;
use std::path::Path;

/// Corners of a ring of a ball, and rings.
const BALL: (u32, u32) = (10, 8);

/// Where the left wheel's pivot is.
const PIVOT: DVec3 = DVec3::new(-1.0, -0.8, 0.5);

/// Writes a cart: a body, below it the axle with two wheels, one of them much smaller than the other. All are balls.
fn write_cart(folder: &Path) {
    let balls = [(Vec3::ZERO, 1.0), (PIVOT.as_vec3(), 0.4), (Vec3::new(1.0, -0.8, 0.5), 0.02)];
    let (mut mesh, mut of_triangles) = (Mesh::default(), Vec::new());
    for (k, (centre, radius)) in balls.into_iter().enumerate() {
        let first = mesh.positions.len() as u32;
        let (corners, rings) = BALL;
        for (ring, corner) in (0..=rings).flat_map(|ring| (0..corners).map(move |corner| (ring, corner))) {
            let (high, out) = (std::f32::consts::PI * ring as f32 / rings as f32).sin_cos();
            let (z, x) = (std::f32::consts::TAU * corner as f32 / corners as f32).sin_cos();
            mesh.positions.push(centre + radius * Vec3::new(high * x, out, high * z));
            if ring < rings {
                let [a, b] = [corner, (corner + 1) % corners].map(|c| first + ring * corners + c);
                mesh.triangles.extend([[a, b, a + corners], [b, b + corners, a + corners]]);
            }
        }
        mesh.triangle_materials.resize(mesh.triangles.len(), u32::from(k > 0));
        of_triangles.resize(mesh.triangles.len(), [0, 2, 3][k]);
    }
    let at = |translation: DVec3| NodeTransform::Parts {
        translation,
        rotation: DQuat::from_rotation_x(0.5),
        scale: DVec3::splat(0.5),
    };
    let node = |name: &str, parent, rest| Node { name: name.into(), parent, rest };
    // The wheel turns about its own middle, wherever the axle stands.
    let axle = at(DVec3::new(0.0, -0.5, 0.5));
    let wheel = NodeTransform::Matrix(
        axle.to_parent().inverse() * parbake_model::glam::DAffine3::from_translation(PIVOT),
    );
    let nodes = vec![
        node("body", None, NodeTransform::IDENTITY),
        node("axle", Some(0), axle),
        node("wheel L", Some(1), wheel),
        node("wheel R", Some(1), NodeTransform::IDENTITY),
    ];
    let material = |name: &str, base_color| Material { name: name.into(), base_color, ..Material::default() };
    let model = Model {
        name: "cart".into(),
        mesh,
        materials: vec![material("paint", [0.8, 0.1, 0.1, 1.0]), material("rubber", [0.1, 0.1, 0.1, 1.0])],
        parts: Some(Hierarchy { nodes, of_triangles }),
        ..Model::default()
    };
    write_glb(&folder.join("cart.glb"), &model).unwrap();
}

fn read(path: &Path) -> Model {
    read_model(path, &Limits::default()).unwrap().model
}

/// The node of a name, with its triangles and their materials' names.
fn part<'m>(model: &'m Model, name: &str) -> (usize, &'m Node, Vec<&'m str>) {
    let hierarchy = model.nodes.as_ref().unwrap();
    let index = hierarchy.nodes.iter().position(|node| node.name == name).unwrap();
    let triangles = (0..model.mesh.triangles.len()).filter(|&t| hierarchy.of_triangles[t] as usize == index);
    let material = |t: usize| model.materials[model.mesh.triangle_materials[t] as usize].name.as_str();
    (index, &hierarchy.nodes[index], triangles.map(material).collect())
}

/// Protects parts: in each level they are nodes of their own with their names, pivots and materials' names, within the
/// budget; the small one does not vanish; all share the textures; lods.json and draw calls tell of them.
#[test]
fn parts_stay_apart_in_each_level() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    write_cart(folder);
    let levels = ["--screen-size", "48,24", "--triangles", "80,24", "--time-budget", "3", "-o", "lods"];
    run(folder, &[&["lod", "cart.glb", "--keep-parts", "wheel*"], &levels[..]].concat());
    let lods = folder.join("lods");
    let chain = json(&lods.join("lods.json"));
    for (level, most) in chain["levels"].as_array().unwrap().iter().zip([80, 24]) {
        let model = read(&lods.join(level["file"].as_str().unwrap()));
        let count = model.mesh.triangles.len();
        assert!(count <= most && count + 4 > most, "{count} of {most}");
        assert_eq!(level["draw_calls"], 3);
        let mut all = part(&model, &format!("cart_LOD{}", level["level"])).2.len();
        for (told, name) in level["parts"].as_array().unwrap().iter().zip(["wheel L", "wheel R"]) {
            let (_, _, materials) = part(&model, name);
            assert_eq!(
                (told["name"].as_str(), told["triangles"].as_u64()),
                (Some(name), Some(materials.len() as u64))
            );
            assert!(materials.len() >= 4 && materials.iter().all(|material| *material == "rubber"));
            all += materials.len();
        }
        assert_eq!(all, count);
        let hierarchy = model.nodes.as_ref().unwrap();
        let (index, node, _) = part(&model, "wheel L");
        assert_eq!(hierarchy.nodes[node.parent.unwrap()].name, "axle");
        assert!(hierarchy.worlds()[index].translation.distance(PIVOT) < 1e-6);
        let textures =
            |name: &str| model.materials.iter().find(|m| m.name == name).unwrap().base_color_texture;
        let rest = model.materials.iter().map(|m| m.name.as_str()).find(|name| *name != "rubber").unwrap();
        assert_eq!(textures("rubber").map(|slot| slot.image), textures(rest).map(|slot| slot.image));
    }
    // Readers that know no levels see the finest.
    let all = read(&lods.join(chain["all_levels"].as_str().unwrap()));
    assert_eq!(all.mesh.triangles.len() as u64, chain["levels"][0]["triangles"].as_u64().unwrap());
    assert!(part(&all, "wheel R").2.len() >= 4);
    run(folder, &["check", "lods/cart_lods.glb"]);
}

/// Protects one bake with parts, and the words for what cannot be.
#[test]
fn parts_of_one_bake_and_those_in_vain() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    write_cart(folder);
    let small = ["--texture-size", "64", "--time-budget", "2", "--views", "12", "-o", "out.glb"];
    run(folder, &[&["bake", "cart.glb", "-t", "40", "--keep-parts", "axle"], &small[..]].concat());
    let baked = read(&folder.join("out.glb"));
    // What hangs below an axle goes with it.
    assert_eq!(part(&baked, "axle").2.len() + part(&baked, "cart").2.len(), baked.mesh.triangles.len());
    assert!(part(&baked, "axle").2.len() >= 4);
    let refused = |arguments: &[&str], words: &[&str]| {
        let ended = parbake(folder).args(arguments).output().unwrap();
        assert!(!ended.status.success(), "{arguments:?}");
        let told = text(&ended.stderr);
        assert!(words.iter().all(|word| told.contains(word)), "{arguments:?}: {told}");
    };
    refused(
        &["lod", "cart.glb", "--keep-parts", "wheels"],
        &["\"wheels\"", "it has \"wheel L\", \"wheel R\""],
    );
    let few = ["lod", "cart.glb", "--keep-parts", "wheel*", "--triangles", "99,50,8"];
    refused(&few, &["--triangles 8 is too few", "give 12 or more"]);
    refused(&["bake", "cart.glb", "out.glb", "--keep-parts", "axle"], &["--triangles instead of LOW"]);
    refused(&["bake", "cart.glb", "-t", "40", "--keep-parts", "axle", "-o", "a.obj"], &["OBJ has no nodes"]);
    assert!(!folder.join("lods").exists() || fs::read_dir(folder.join("lods")).unwrap().next().is_none());
}
