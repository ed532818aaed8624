// Custom Function nodes for Shader Graph: type File, this file, name `ParbakeParallax`. Precision single.
#define PARBAKE_ROW_0_AT_BOTTOM
#include "ParbakeParallax.hlsl"

// ViewDirection, Normal, Tangent and Bitangent in one space, of the vertices; UV as Unity has it. ShiftedUV is where
// colours are to be fetched; Opacity is to be clipped where it is negative. LinearClamp: a Sampler State node.
void ParbakeParallax_float(float2 UV, float3 ViewDirection, float3 Normal, float3 Tangent, float3 Bitangent,
    UnityTexture2D ShiftMap, UnityTexture2D CutoutMap, UnitySamplerState LinearClamp,
    float4 ShiftScale0, float4 ShiftScale1, float4 ShiftOffset0, float4 ShiftOffset1,
    float4 CutoutScale0, float4 CutoutScale1, float4 CutoutScale2,
    float4 CutoutOffset0, float4 CutoutOffset1, float4 CutoutOffset2,
    float Limit, float FadeFootprint, out float2 ShiftedUV, out float Opacity)
{
    float2 t = ParbakeFlipped(UV);
    float3 w = ParbakeLineOfFrame(normalize(ViewDirection), Normal, Tangent, Bitangent);
    float fade = ParbakeFade(ddx(UV), ddy(UV), w.z, FadeFootprint);
    ShiftedUV = ParbakeFlipped(t + fade * ParbakeShiftAt(ShiftMap.tex, LinearClamp.samplerstate, t, w,
        ShiftScale0, ShiftScale1, ShiftOffset0, ShiftOffset1, Limit));
    Opacity = ParbakeFaded(ParbakeOpacityAt(CutoutMap.tex, LinearClamp.samplerstate, t, w, CutoutScale0,
        CutoutScale1, CutoutScale2, CutoutOffset0, CutoutOffset1, CutoutOffset2), fade);
}
