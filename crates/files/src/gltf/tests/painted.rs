//! Importances that are painted in a vertex attribute.

use super::*;
use crate::context::{Context, Textures};

fn painted(document: &Value, attribute: &str) -> Result<Vec<f32>, String> {
    let (limits, text) = (Limits::default(), document.to_string());
    let mut context = Context::new(Path::new("x/a.gltf"), &NoResources, &limits, Textures::Decode);
    context.attribute = Some(attribute);
    read(context, text.as_bytes()).map(|loaded| loaded.model.painted).map_err(|error| error.to_string())
}

/// Protects painters: a number of their own and a colour's red are read in any kind of numbers, a triangle has the mean
/// of its corners, what is not painted has a half, and an attribute in vain is told with those that there are.
#[test]
fn importances_are_read() {
    let mut document = document(&TRIANGLE);
    let number = add(&mut document, "SCALAR", 5126, 3, &floats(&[0.2, 0.4, 7.0]));
    let color = add(&mut document, "VEC4", 5121, 3, &[255, 9, 9, 9, 0, 9, 9, 9, 0, 9, 9, 9]);
    document["accessors"][color]["normalized"] = true.into();
    let bare = document["meshes"][0]["primitives"][0].clone();
    document["meshes"][0]["primitives"][0]["attributes"]["_IMPORTANCE"] = number.into();
    document["meshes"][0]["primitives"][0]["attributes"]["COLOR_1"] = color.into();
    document["meshes"][0]["primitives"].as_array_mut().unwrap().push(bare);
    // Beyond the range is its end.
    let found = painted(&document, "_IMPORTANCE").unwrap();
    assert!((found[0] - 1.6 / 3.0).abs() < 1e-6 && found[1..] == [0.5], "{found:?}");
    let found = painted(&document, "COLOR_1").unwrap();
    assert!((found[0] - 1.0 / 3.0).abs() < 1e-6 && found[1..] == [0.5], "{found:?}");
    assert!(read_value(&document).unwrap().model.painted.is_empty());
    let error = painted(&document, "_WEIGHT").unwrap_err();
    assert!(error.contains("a.gltf") && error.contains("COLOR_1, _IMPORTANCE"), "{error}");
}
