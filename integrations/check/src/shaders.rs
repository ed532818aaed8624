//! The shaders' pure functions, compiled to naga's IR and validated.

use naga::valid::{Capabilities, ValidationFlags, Validator};
use naga::{Module, ShaderStage};
use std::path::{Path, PathBuf};
use std::process::Command;

/// A file of `integrations/`, as text.
pub(crate) fn read(path: &str) -> String {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("..").join(path);
    std::fs::read_to_string(&path).unwrap_or_else(|error| panic!("{}: {error}", path.display()))
}

fn validated(name: &str, module: Module) -> Module {
    Validator::new(ValidationFlags::all(), Capabilities::all())
        .validate(&module)
        .unwrap_or_else(|error| panic!("{name}: {}", error.into_inner()));
    module
}

/// Bevy's: naga's own language, but for the line by which Bevy finds the module.
pub(crate) fn wgsl() -> Module {
    let source: String = read("bevy/src/parallax.wgsl")
        .lines()
        .map(|line| if line.starts_with("#define_import_path") { "\n".into() } else { format!("{line}\n") })
        .collect();
    let module = naga::front::wgsl::parse_str(&source)
        .unwrap_or_else(|error| panic!("{}", error.emit_to_string_with_path(&source, "parallax.wgsl")));
    validated("parallax.wgsl", module)
}

/// Godot's, as GLSL.
pub(crate) fn godot() -> Module {
    let functions = read("godot/addons/parbake_parallax/parallax.gdshaderinc");
    let source = format!("#version 450\n{functions}\nvoid main() {{}}\n");
    let module = naga::front::glsl::Frontend::default()
        .parse(&naga::front::glsl::Options::from(ShaderStage::Fragment), &source)
        .unwrap_or_else(|errors| panic!("{}", errors.emit_to_string(&source)));
    validated("parallax.gdshaderinc", module)
}

/// That of Unity and Unreal, by way of SPIR-V. glslang puts all functions into `main`, so that is what runs: its
/// inputs are the functions' arguments, its outputs what they return.
pub(crate) fn hlsl() -> Option<Module> {
    const MAIN: &str = "
        Texture2D shiftMap; Texture2D cutoutMap; SamplerState linearClamp;
        struct Outputs { float4 first : SV_Target0; float4 second : SV_Target1; float4 third : SV_Target2; };
        Outputs main(float3 toViewer : A0, float3 normal : A1, float3 tangent : A2, float3 view_direction : A3, float2 t : A4,
            float2 along : A5, float2 down : A6, float4 rest : A7, float4 a : A8, float4 b : A9, float4 c : A10,
            float4 d : A11, float4 e : A12, float4 f : A13) {
            Outputs outputs;
            float3 bitangent = cross(normal, tangent) * rest.x;
            float3 w = ParbakeLine(toViewer, normal, tangent, rest.x);
            float3 same = ParbakeLineOfFrame(toViewer, normal, tangent, bitangent);
            outputs.first = float4(w, length(w - same));
            outputs.second = float4(
                ParbakeShiftAt(shiftMap, linearClamp, t, view_direction, a, b, c, d, rest.y),
                ParbakeOpacityAt(cutoutMap, linearClamp, t, view_direction, a, b, c, d, e, f), 0.0);
            outputs.third = float4(ParbakeFade(along, down, rest.z, rest.w), ParbakeFaded(rest.y, rest.z),
                ParbakeCoverage(rest.y, rest.z), ParbakeFlipped(t).y);
            return outputs;
        }";
    let source = read("hlsl/ParbakeParallax.hlsl") + MAIN;
    let words = glslang("hlsl", &["-D", "-e", "main", "--amb", "--aml"], &source)?;
    let module = naga::front::spv::parse_u8_slice(&words, &naga::front::spv::Options::default())
        .unwrap_or_else(|error| panic!("ParbakeParallax.hlsl: {error}"));
    Some(validated("ParbakeParallax.hlsl", module))
}

/// SPIR-V of a fragment shader. None without glslang, which is said; on a server for tests it has to be there.
pub(crate) fn glslang(language: &str, options: &[&str], source: &str) -> Option<Vec<u8>> {
    let folder = tempfile::tempdir().expect("a folder for temporary files");
    let (input, output) = (folder.path().join("shader.frag"), folder.path().join("shader.spv"));
    std::fs::write(&input, source).expect("the folder can be written");
    // HLSL is for Vulkan; of GLSL, OpenGL alone has uniforms with defaults.
    let target: &[&str] = if options.contains(&"-G") { &[] } else { &["-V"] };
    let command =
        Command::new(program()).args(target).args(options).arg("-o").arg(&output).arg(&input).output();
    let ran = match command {
        Ok(ran) => ran,
        Err(error) => {
            assert!(std::env::var_os("CI").is_none(), "glslangValidator cannot be started: {error}");
            eprintln!("skipped: {language} needs glslangValidator (Debian: glslang-tools), and {error}");
            return None;
        }
    };
    assert!(
        ran.status.success(),
        "{language}: {}\n{}",
        String::from_utf8_lossy(&ran.stdout),
        numbered(source)
    );
    Some(std::fs::read(output).expect("glslang wrote what it compiled"))
}

fn program() -> PathBuf {
    std::env::var_os("GLSLANG").map_or_else(|| "glslangValidator".into(), PathBuf::from)
}

/// With line numbers, for errors.
fn numbered(source: &str) -> String {
    source.lines().enumerate().map(|(i, line)| format!("{:4} {line}\n", i + 1)).collect()
}
