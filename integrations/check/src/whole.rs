//! Shaders that need an engine, compiled with stand-ins for what the engine declares: syntax, types and names are
//! checked, and what the engine does with them is not.

use crate::shaders::{glslang, read};

/// What Godot declares for shaders of kind `spatial`. Its words that GLSL does not have are taken out of the shader.
const GODOT: &str = "
vec3 NORMAL, TANGENT, BINORMAL, VIEW, NORMAL_MAP, ALBEDO, EMISSION;
vec2 UV;
vec4 COLOR;
mat4 MODELVIEW_MATRIX, PROJECTION_MATRIX;
mat3 MODELVIEW_NORMAL_MATRIX;
float ALPHA, NORMAL_MAP_DEPTH, METALLIC, ROUGHNESS, AO;
";

/// A file of the plug-in with what it includes, in Godot's language.
fn with_includes(path: &str) -> String {
    let line_of = |line: &str| match line.trim().strip_prefix("#include \"res://") {
        Some(included) => with_includes(&format!("godot/{}", included.trim_end_matches('"'))),
        None => format!("{line}\n"),
    };
    read(path).lines().map(line_of).collect()
}

/// As GLSL: without kinds, modes and groups, and without the hints of uniforms.
fn as_glsl(source: &str) -> String {
    let line_of = |line: &str| {
        let trimmed = line.trim();
        if ["shader_type", "render_mode", "group_uniforms"].iter().any(|word| trimmed.starts_with(word)) {
            return "\n".to_string();
        }
        let line = line.strip_prefix("varying ").unwrap_or(line);
        let Some((before, after)) = line.split_once(" : ").filter(|_| trimmed.starts_with("uniform")) else {
            return format!("{line}\n");
        };
        // What follows the hints is a default, which GLSL has as well.
        let default = after.rsplit_once(" = ").map_or(";".into(), |(_, value)| format!(" = {value}"));
        format!("{before}{default}\n")
    };
    source.lines().map(line_of).collect()
}

/// Protects Godot's material, in each form that the import plug-in makes of it.
#[test]
fn godot_s_material_compiles() {
    let own = with_includes("godot/addons/parbake_parallax/parallax.gdshader");
    for defined in ["", "PARALLAX_CUTOUT", "PARALLAX_BLEND"] {
        let line = if defined.is_empty() { String::new() } else { format!("#define {defined}\n") };
        let source = own.replace("#define PARALLAX_CUTOUT\n", &line);
        assert!(defined == "PARALLAX_CUTOUT" || source != own, "the shader's line to exchange is not there");
        let main = "void main() { vertex(); fragment(); }";
        let source = format!("#version 450\n{GODOT}{}{main}\n", as_glsl(&source));
        glslang("Godot's material", &["-G", "--amb", "--aml"], &source);
    }
}

/// What Unity's Universal Render Pipeline declares, of which the shader uses these.
const UNITY: &str = "
#define CBUFFER_START(name) cbuffer name {
#define CBUFFER_END };
#define UNITY_VERTEX_INPUT_INSTANCE_ID
#define UNITY_SETUP_INSTANCE_ID(input)
cbuffer Stand { float4x4 anyMatrix; float3 anyPoint; };
struct SurfaceData { float3 albedo, specular, normalTS, emission; float metallic, smoothness, occlusion, alpha; };
struct InputData { float3 positionWS, normalWS, viewDirectionWS, bakedGI; float4 shadowCoord, shadowMask;
    float fogCoord; float2 normalizedScreenSpaceUV; };
float3 TransformObjectToWorld(float3 p) { return mul(anyMatrix, float4(p, 1.0)).xyz; }
float3 TransformObjectToWorldDir(float3 p) { return mul((float3x3)anyMatrix, p); }
float3 TransformObjectToWorldNormal(float3 p) { return mul((float3x3)anyMatrix, p); }
float4 TransformWorldToHClip(float3 p) { return mul(anyMatrix, float4(p, 1.0)); }
float4 TransformWorldToShadowCoord(float3 p) { return mul(anyMatrix, float4(p, 1.0)); }
float GetOddNegativeScale() { return anyPoint.x < 0.0 ? -1.0 : 1.0; }
float ComputeFogFactor(float z) { return z; }
float3 ApplyShadowBias(float3 p, float3 n, float3 d) { return p + n + d; }
float4 ApplyShadowClamping(float4 p) { return p; }
float3 GetWorldSpaceNormalizeViewDir(float3 p) { return normalize(anyPoint - p); }
float3 UnpackNormalScale(float4 packed, float scale) { return packed.xyz * scale; }
float3 SampleSH(float3 n) { return n; }
float2 GetNormalizedScreenSpaceUV(float4 p) { return p.xy; }
float4 UniversalFragmentPBR(InputData i, SurfaceData s) { return float4(s.albedo * i.bakedGI, s.alpha); }
float3 MixFog(float3 color, float fog) { return color * fog; }
struct UnityTexture2D { Texture2D tex; };
struct UnitySamplerState { SamplerState samplerstate; };
";

/// HLSL with Parbake's own file put in, and the engine's files left out.
fn unity(path: &str) -> String {
    let line_of = |line: &str| match line.trim().strip_prefix("#include \"") {
        Some("ParbakeParallax.hlsl\"") => read("hlsl/ParbakeParallax.hlsl"),
        Some(_) => "\n".into(),
        None => format!("{line}\n"),
    };
    read(path).lines().map(line_of).collect()
}

/// Protects Unity's passes: those that the shader names are there, and compile.
#[test]
fn unity_s_passes_compile() {
    let shader = read("hlsl/unity/ParbakeParallaxLit.shader");
    let passes =
        format!("{UNITY}#define PARBAKE_ROW_0_AT_BOTTOM\n{}", unity("hlsl/unity/ParbakeParallaxLit.hlsl"));
    let named = |pragma: &str| -> Vec<String> {
        let names = shader.lines().filter_map(|line| line.trim().strip_prefix(pragma));
        names.map(|name| name.trim().to_string()).collect()
    };
    let (vertex, fragment) = (named("#pragma vertex "), named("#pragma fragment "));
    assert_eq!((vertex.len(), fragment.len()), (4, 4));
    for point_light in ["", "#define _CASTING_PUNCTUAL_LIGHT_SHADOW\n"] {
        let source = format!("{point_light}{passes}");
        for name in &fragment {
            glslang("Unity's fragments", &["-D", "-e", name, "--amb", "--aml"], &source);
        }
        for name in &vertex {
            glslang("Unity's vertices", &["-D", "-S", "vert", "-e", name, "--amb", "--aml"], &source);
        }
    }
}

/// Protects the constants of Unity's properties: each number of the shader is a property of the material.
#[test]
fn unity_s_properties_are_those_of_its_passes() {
    let shader = read("hlsl/unity/ParbakeParallaxLit.shader");
    let passes = read("hlsl/unity/ParbakeParallaxLit.hlsl");
    let buffer =
        passes.split("CBUFFER_START").nth(1).and_then(|rest| rest.split("CBUFFER_END").next()).unwrap();
    let names =
        buffer.split([' ', ',', ';', '\n']).filter(|word| word.starts_with('_') && !word.ends_with("_ST"));
    for name in names {
        assert!(shader.contains(&format!("{name}(\"")), "{name} is no property");
    }
}

/// Protects the node of Unity's Shader Graph.
#[test]
fn unity_s_node_compiles() {
    let node = unity("hlsl/unity/ParbakeParallaxGraph.hlsl");
    let main = "
        UnityTexture2D shiftMap; UnityTexture2D cutoutMap; UnitySamplerState samp;
        float4 main(float4 p : TEXCOORD0) : SV_Target {
            float2 uv; float opacity;
            ParbakeParallax_float(p.xy, p.xyz, p.xyz, p.yzw, p.zwx, shiftMap, cutoutMap, samp, p, p, p, p, p, p, p, p, p,
                p, 0.25, 0.0625, uv, opacity);
            return float4(uv, opacity, 1.0);
        }";
    glslang("Unity's node", &["-D", "-e", "main", "--amb", "--aml"], &format!("{UNITY}{node}{main}"));
}

/// Protects the node of Unreal's materials, which Unreal puts into a function.
#[test]
fn unreal_s_node_compiles() {
    let node = read("hlsl/unreal/ParallaxNode.hlsl");
    let main = format!(
        "struct FMaterialPixelParameters {{ float3x3 TangentToWorld; }};
        Texture2D ShiftMap; SamplerState ShiftMapSampler; Texture2D CutoutMap; SamplerState CutoutMapSampler;
        float2 Custom(FMaterialPixelParameters Parameters, float2 UV, float3 ToViewer, float4 ShiftScale0,
            float4 ShiftScale1, float4 ShiftOffset0, float4 ShiftOffset1, float4 CutoutScale0, float4 CutoutScale1,
            float4 CutoutScale2, float4 CutoutOffset0, float4 CutoutOffset1, float4 CutoutOffset2, float Limit,
            float FadeFootprint, inout float Opacity) {{
            {node}
        }}
        float4 main(float4 p : TEXCOORD0, float3x3 frame : TEXCOORD1) : SV_Target {{
            FMaterialPixelParameters parameters;
            parameters.TangentToWorld = frame;
            float opacity = 0.0;
            float2 uv = Custom(parameters, p.xy, p.xyz, p, p, p, p, p, p, p, p, p, p, 0.25, 0.0625, opacity);
            return float4(uv, opacity, 1.0);
        }}"
    );
    let source = read("hlsl/ParbakeParallax.hlsl") + &main;
    glslang("Unreal's node", &["-D", "-e", "main", "--amb", "--aml"], &source);
}

/// Protects readers that take the shader of the format page as it is.
#[test]
fn the_shader_of_the_format_page_compiles() {
    let page = read("../docs/parallax_format.md");
    let shader = page.split("```glsl\n").nth(1).and_then(|rest| rest.split("```").next()).unwrap();
    // What its last lines have in a comment is the fragment shader.
    let (functions, main) = shader.split_once("// In the fragment shader:\n").unwrap();
    let main: String = main.lines().map(|line| format!("{}\n", line.trim_start_matches("//"))).collect();
    let source = format!(
        "#version 310 es
        precision highp float; precision highp int;
        uniform sampler2D baseColorMap, normalMap;
        in vec2 uv; in vec3 position, normal; in vec4 tangent; uniform vec3 eye; out vec4 shown;
        {functions}
        void main() {{
            {main}
            shown = color + bump.xyzz;
        }}"
    );
    glslang("the format page", &["-G", "--amb", "--aml"], &source);
}
