// The formulas of PARBAKE_materials_parallax, version 2, in HLSL, for Unity, Unreal and others. Everything is a function
// of its arguments; vectors are in any one space, texture coordinates have v downwards unless said otherwise.
#ifndef PARBAKE_PARALLAX_INCLUDED
#define PARBAKE_PARALLAX_INCLUDED

// The line of sight in the frame (tangent, bitangent, normal): the same from either of its ends. side is the handedness
// of the tangent frame, negated where the object mirrors; the normal is the vertices', whatever side is seen.
float3 ParbakeLine(float3 toViewer, float3 normal, float3 tangent, float side)
{
    float3 n = normalize(normal);
    float3 t = normalize(tangent - n * dot(n, tangent));
    float3 b = cross(n, t) * side;
    float3 w = float3(dot(toViewer, t), dot(toViewer, b), dot(toViewer, n));
    return w.z < 0.0 ? -w : w;
}

// The same for frames whose bitangent is known: b grows against v, as green grows in normal maps of glTF.
float3 ParbakeLineOfFrame(float3 toViewer, float3 normal, float3 tangent, float3 bitangent)
{
    return ParbakeLine(toViewer, normal, tangent, dot(cross(normal, tangent), bitangent) < 0.0 ? -1.0 : 1.0);
}

// Four pairs of coefficients, of x, y, xz and yz, in texture widths and heights.
float2 ParbakeShift(float4 first, float4 second, float3 w, float limit)
{
    float4 pairs = first + second * w.z;
    return (pairs.xy * w.x + pairs.zw * w.y) / max(w.z, limit);
}

// Twelve coefficients, of functions that are orthonormal over the hemisphere.
float ParbakeOpacity(float4 a, float4 b, float4 c, float3 w)
{
    float z = w.z;
    float square = z * z;
    float2 two = float2(w.x * w.x - w.y * w.y, 2.0 * w.x * w.y);
    float2 three = float2(w.x * two.x - w.y * two.y, w.x * two.y + w.y * two.x);
    float4 rings = float4(
        1.0,
        1.7320508 * (2.0 * z - 1.0),
        2.236068 * (6.0 * (square - z) + 1.0),
        2.6457513 * ((20.0 * z - 30.0) * square + 12.0 * z - 1.0));
    float4 wave = float4(1.7320508 * w.xy, 7.108338 * (z - 0.375) * w.xy);
    float4 waves = float4(1.9364917 * two, 2.09165 * three);
    return dot(a, rings) + dot(b, wave) + dot(c, waves);
}

// How much of the maps is left under a pixel with these gradients of the coordinate; z makes them those of a surface
// that is seen face on.
float ParbakeFade(float2 along, float2 down, float z, float footprint)
{
    return saturate(2.0 - z * max(length(along), length(down)) / footprint);
}

// The opacity under a fade. The fragment is to be discarded where it is negative.
float ParbakeFaded(float opacity, float fade)
{
    return 1.0 + fade * (opacity - 1.0);
}

// How much of a pixel is covered, for alpha to coverage. The width is fwidth of the opacity, bounded since past the edge
// of a triangle it is any number.
float ParbakeCoverage(float opacity, float width)
{
    return saturate(0.5 + opacity / clamp(width, 1e-6, 10.0));
}

// Where a layer of an image has the coordinate t: layers lie one below the other, each of so many rows. Half a row is
// kept from the next layer.
float2 ParbakeStrip(float2 t, float layer, float layers, float rows)
{
    return float2(t.x, (layer + clamp(t.y, 0.5 / rows, 1.0 - 0.5 / rows)) / layers);
}

// Engines whose first row of an image is v = 0 at the bottom, as Unity, ask for a fetch from there.
float2 ParbakeFlipped(float2 t)
{
    return float2(t.x, 1.0 - t.y);
}

// Four channels at t, from an image of layers one below the other. Define PARBAKE_ROW_0_AT_BOTTOM where the engine has
// the first row of an image at v = 1.
float4 ParbakeLayer(Texture2D map, SamplerState linearClamp, float2 t, float layer, float layers)
{
    float width, height;
    map.GetDimensions(width, height);
    float2 at = ParbakeStrip(t, layer, layers, height / layers);
#ifdef PARBAKE_ROW_0_AT_BOTTOM
    at = ParbakeFlipped(at);
#endif
    return map.SampleLevel(linearClamp, at, 0.0);
}

// The shift at t. scale and offset are the extension's, four numbers a layer.
float2 ParbakeShiftAt(Texture2D map, SamplerState linearClamp, float2 t, float3 w, float4 scale0, float4 scale1,
    float4 offset0, float4 offset1, float limit)
{
    return ParbakeShift(
        offset0 + scale0 * ParbakeLayer(map, linearClamp, t, 0.0, 2.0),
        offset1 + scale1 * ParbakeLayer(map, linearClamp, t, 1.0, 2.0),
        w, limit);
}

// The opacity at t.
float ParbakeOpacityAt(Texture2D map, SamplerState linearClamp, float2 t, float3 w, float4 scale0, float4 scale1,
    float4 scale2, float4 offset0, float4 offset1, float4 offset2)
{
    return ParbakeOpacity(
        offset0 + scale0 * ParbakeLayer(map, linearClamp, t, 0.0, 3.0),
        offset1 + scale1 * ParbakeLayer(map, linearClamp, t, 1.0, 3.0),
        offset2 + scale2 * ParbakeLayer(map, linearClamp, t, 2.0, 3.0),
        w);
}

#endif
