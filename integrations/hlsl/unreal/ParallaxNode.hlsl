// The code of a Custom node in an Unreal material: paste it there. unreal/README.md says which inputs and outputs the
// node has. Unreal's bitangent grows downwards in the texture, and the format's upwards, hence its sign.
float3 n = Parameters.TangentToWorld[2];
float3 t = Parameters.TangentToWorld[0];
float3 b = -Parameters.TangentToWorld[1];
float3 w = ParbakeLineOfFrame(ToViewer, n, t, b);
float fade = ParbakeFade(ddx(UV), ddy(UV), w.z, FadeFootprint);
Opacity = ParbakeFaded(ParbakeOpacityAt(CutoutMap, CutoutMapSampler, UV, w, CutoutScale0, CutoutScale1, CutoutScale2,
    CutoutOffset0, CutoutOffset1, CutoutOffset2), fade);
return UV + fade * ParbakeShiftAt(ShiftMap, ShiftMapSampler, UV, w, ShiftScale0, ShiftScale1, ShiftOffset0,
    ShiftOffset1, Limit);
