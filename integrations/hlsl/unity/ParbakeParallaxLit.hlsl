// The passes of ParbakeParallaxLit.shader. One function, `Parbake`, finds the line of sight, what is cut out, and the
// shift; colours are fetched with the gradients of the unshifted coordinate.
#include "Packages/com.unity.render-pipelines.universal/ShaderLibrary/Core.hlsl"
#include "Packages/com.unity.render-pipelines.universal/ShaderLibrary/Lighting.hlsl"
#include "Packages/com.unity.render-pipelines.universal/ShaderLibrary/Shadows.hlsl"
#include "ParbakeParallax.hlsl"

CBUFFER_START(UnityPerMaterial)
    float4 _BaseMap_ST;
    float4 _BaseColor;
    float4 _EmissionColor;
    float4 _ShiftScale0, _ShiftScale1, _ShiftOffset0, _ShiftOffset1;
    float4 _CutoutScale0, _CutoutScale1, _CutoutScale2, _CutoutOffset0, _CutoutOffset1, _CutoutOffset2;
    float _Limit, _FadeFootprint, _Cutoff, _BumpScale, _Metallic, _Roughness, _AlphaToMask;
CBUFFER_END

Texture2D _BaseMap;
Texture2D _BumpMap;
Texture2D _MetallicRoughnessMap;
Texture2D _OcclusionMap;
Texture2D _EmissionMap;
Texture2D _ShiftMap;
Texture2D _CutoutMap;
SamplerState sampler_BaseMap;
// Unity makes this sampler from its name.
SamplerState sampler_linear_clamp;

// Of the light whose shadow is drawn.
float3 _LightDirection;
float3 _LightPosition;

struct Attributes
{
    float4 positionOS : POSITION;
    float3 normalOS : NORMAL;
    float4 tangentOS : TANGENT;
    float2 uv : TEXCOORD0;
    UNITY_VERTEX_INPUT_INSTANCE_ID
};

struct Varyings
{
    float4 positionCS : SV_POSITION;
    float3 positionWS : TEXCOORD0;
    float3 normalWS : TEXCOORD1;
    // w is the handedness, negated where the object mirrors.
    float4 tangentWS : TEXCOORD2;
    float2 uv : TEXCOORD3;
    float fogFactor : TEXCOORD4;
};

Varyings ParbakeVertex(Attributes input)
{
    UNITY_SETUP_INSTANCE_ID(input);
    Varyings output;
    output.positionWS = TransformObjectToWorld(input.positionOS.xyz);
    output.positionCS = TransformWorldToHClip(output.positionWS);
    output.normalWS = TransformObjectToWorldNormal(input.normalOS);
    output.tangentWS = float4(TransformObjectToWorldDir(input.tangentOS.xyz), input.tangentOS.w * GetOddNegativeScale());
    output.uv = input.uv * _BaseMap_ST.xy + _BaseMap_ST.zw;
    output.fogFactor = ComputeFogFactor(output.positionCS.z);
    return output;
}

float3 ParbakeToLight(float3 positionWS)
{
#if defined(_CASTING_PUNCTUAL_LIGHT_SHADOW)
    return normalize(_LightPosition - positionWS);
#else
    return _LightDirection;
#endif
}

Varyings ParbakeShadowVertex(Attributes input)
{
    Varyings output = ParbakeVertex(input);
    float3 biased = ApplyShadowBias(output.positionWS, output.normalWS, ParbakeToLight(output.positionWS));
    output.positionCS = ApplyShadowClamping(TransformWorldToHClip(biased));
    return output;
}

struct ParbakeSeen
{
    // The coordinate to fetch colours at, as Unity has it, and the gradients to fetch them with.
    float2 uv, along, down;
    // What is not negative is there.
    float opacity;
};

ParbakeSeen Parbake(Varyings input, float3 toViewer)
{
    ParbakeSeen seen;
    seen.along = ddx(input.uv);
    seen.down = ddy(input.uv);
    float2 t = ParbakeFlipped(input.uv);
    float3 w = ParbakeLine(toViewer, input.normalWS, input.tangentWS.xyz, input.tangentWS.w);
    float fade = ParbakeFade(seen.along, seen.down, w.z, _FadeFootprint);
    float opacity = ParbakeOpacityAt(_CutoutMap, sampler_linear_clamp, t, w, _CutoutScale0, _CutoutScale1,
        _CutoutScale2, _CutoutOffset0, _CutoutOffset1, _CutoutOffset2);
    float2 shift = ParbakeShiftAt(_ShiftMap, sampler_linear_clamp, t, w, _ShiftScale0, _ShiftScale1, _ShiftOffset0,
        _ShiftOffset1, _Limit);
    seen.opacity = ParbakeFaded(opacity, fade);
    seen.uv = ParbakeFlipped(t + fade * shift);
    return seen;
}

float4 ParbakeFetch(Texture2D map, ParbakeSeen seen)
{
    return map.SampleGrad(sampler_BaseMap, seen.uv, seen.along, seen.down);
}

// Base colour, where the material's alpha leaves it.
float4 ParbakeColor(ParbakeSeen seen)
{
    float4 color = _BaseColor * ParbakeFetch(_BaseMap, seen);
    clip(color.a - _Cutoff);
    return color;
}

float3 ParbakeNormal(Varyings input, ParbakeSeen seen, bool isFront)
{
    float3 bump = UnpackNormalScale(ParbakeFetch(_BumpMap, seen), _BumpScale);
    float3 n = normalize(input.normalWS);
    float3 t = normalize(input.tangentWS.xyz - n * dot(n, input.tangentWS.xyz));
    float3 b = cross(n, t) * input.tangentWS.w;
    float3 normal = normalize(bump.x * t + bump.y * b + bump.z * n);
    return isFront ? normal : -normal;
}

float4 ParbakeForward(Varyings input, bool isFront : SV_IsFrontFace) : SV_Target
{
    float3 toViewer = GetWorldSpaceNormalizeViewDir(input.positionWS);
    ParbakeSeen seen = Parbake(input, toViewer);
    // Before anything is discarded, since it looks at neighbours.
    float coverage = ParbakeCoverage(seen.opacity, fwidth(seen.opacity));
    if (_AlphaToMask == 0.0) coverage = step(0.0, seen.opacity);
    clip(coverage - 1e-6);
    float4 color = ParbakeColor(seen);
    float4 orm = ParbakeFetch(_MetallicRoughnessMap, seen);

    SurfaceData surface = (SurfaceData)0;
    surface.albedo = color.rgb;
    surface.alpha = 1.0;
    surface.metallic = _Metallic * orm.b;
    surface.smoothness = 1.0 - _Roughness * orm.g;
    surface.occlusion = ParbakeFetch(_OcclusionMap, seen).r;
    surface.emission = _EmissionColor.rgb * ParbakeFetch(_EmissionMap, seen).rgb;
    surface.normalTS = float3(0.0, 0.0, 1.0);

    InputData inputs = (InputData)0;
    inputs.positionWS = input.positionWS;
    inputs.normalWS = ParbakeNormal(input, seen, isFront);
    inputs.viewDirectionWS = toViewer;
    inputs.shadowCoord = TransformWorldToShadowCoord(input.positionWS);
    inputs.fogCoord = input.fogFactor;
    inputs.bakedGI = SampleSH(inputs.normalWS);
    inputs.normalizedScreenSpaceUV = GetNormalizedScreenSpaceUV(input.positionCS);
    inputs.shadowMask = float4(1.0, 1.0, 1.0, 1.0);

    float4 lit = UniversalFragmentPBR(inputs, surface);
    return float4(MixFog(lit.rgb, input.fogFactor), coverage);
}

float4 ParbakeShadow(Varyings input) : SV_Target
{
    // A line passes beside the model whichever of its ends is the eye: here it is the light.
    ParbakeSeen seen = Parbake(input, ParbakeToLight(input.positionWS));
    clip(seen.opacity);
    ParbakeColor(seen);
    return 0.0;
}

float4 ParbakeDepth(Varyings input) : SV_Target
{
    ParbakeSeen seen = Parbake(input, GetWorldSpaceNormalizeViewDir(input.positionWS));
    clip(seen.opacity);
    ParbakeColor(seen);
    return input.positionCS.z;
}

float4 ParbakeDepthNormals(Varyings input, bool isFront : SV_IsFrontFace) : SV_Target
{
    ParbakeSeen seen = Parbake(input, GetWorldSpaceNormalizeViewDir(input.positionWS));
    clip(seen.opacity);
    ParbakeColor(seen);
    return float4(ParbakeNormal(input, seen, isFront), 0.0);
}
