// glTF's metallic-roughness material with parallax maps and a cutout, for Unity's Universal Render Pipeline. Unity's
// texture coordinates have v upwards, the format's downwards: `ParbakeFlipped` goes from one to the other.
Shader "Parbake/Parallax Lit"
{
    Properties
    {
        [MainColor] _BaseColor("Base colour", Color) = (1, 1, 1, 1)
        [MainTexture] _BaseMap("Base colour texture", 2D) = "white" {}
        _Cutoff("Alpha cutoff (0: none)", Range(0, 1)) = 0
        [Normal] _BumpMap("Normal texture", 2D) = "bump" {}
        _BumpScale("Normal scale", Float) = 1
        _Metallic("Metallic", Range(0, 1)) = 0
        _Roughness("Roughness", Range(0, 1)) = 1
        _MetallicRoughnessMap("Metallic (B), roughness (G)", 2D) = "white" {}
        _OcclusionMap("Occlusion (R)", 2D) = "white" {}
        [HDR] _EmissionColor("Emission", Color) = (0, 0, 0, 1)
        _EmissionMap("Emission texture", 2D) = "white" {}
        [NoScaleOffset] _ShiftMap("Shift (linear, no mip levels)", 2D) = "black" {}
        _ShiftScale0("Shift, scale 0-3", Vector) = (0, 0, 0, 0)
        _ShiftScale1("Shift, scale 4-7", Vector) = (0, 0, 0, 0)
        _ShiftOffset0("Shift, offset 0-3", Vector) = (0, 0, 0, 0)
        _ShiftOffset1("Shift, offset 4-7", Vector) = (0, 0, 0, 0)
        [NoScaleOffset] _CutoutMap("Cutout (linear, no mip levels)", 2D) = "black" {}
        // As these are, nothing is cut out.
        _CutoutScale0("Cutout, scale 0-3", Vector) = (0, 0, 0, 0)
        _CutoutScale1("Cutout, scale 4-7", Vector) = (0, 0, 0, 0)
        _CutoutScale2("Cutout, scale 8-11", Vector) = (0, 0, 0, 0)
        _CutoutOffset0("Cutout, offset 0-3", Vector) = (1, 0, 0, 0)
        _CutoutOffset1("Cutout, offset 4-7", Vector) = (0, 0, 0, 0)
        _CutoutOffset2("Cutout, offset 8-11", Vector) = (0, 0, 0, 0)
        _Limit("Limit", Range(0.01, 1)) = 0.25
        _FadeFootprint("Fade footprint", Float) = 0.0625
        [ToggleUI] _AlphaToMask("Smooth borders (with MSAA only)", Float) = 0
    }

    SubShader
    {
        Tags { "RenderPipeline" = "UniversalPipeline" "RenderType" = "TransparentCutout" "Queue" = "AlphaTest" }
        Cull Off

        HLSLINCLUDE
        #pragma target 4.5
        #define PARBAKE_ROW_0_AT_BOTTOM
        #include "ParbakeParallaxLit.hlsl"
        ENDHLSL

        Pass
        {
            Name "ForwardLit"
            Tags { "LightMode" = "UniversalForward" }
            AlphaToMask [_AlphaToMask]

            HLSLPROGRAM
            #pragma vertex ParbakeVertex
            #pragma fragment ParbakeForward
            #pragma multi_compile _ _MAIN_LIGHT_SHADOWS _MAIN_LIGHT_SHADOWS_CASCADE _MAIN_LIGHT_SHADOWS_SCREEN
            #pragma multi_compile _ _ADDITIONAL_LIGHTS
            #pragma multi_compile _ _FORWARD_PLUS _CLUSTER_LIGHT_LOOP
            #pragma multi_compile_fragment _ _ADDITIONAL_LIGHT_SHADOWS
            #pragma multi_compile_fragment _ _SHADOWS_SOFT
            #pragma multi_compile_fog
            #pragma multi_compile_instancing
            ENDHLSL
        }

        Pass
        {
            Name "ShadowCaster"
            Tags { "LightMode" = "ShadowCaster" }
            ColorMask 0

            HLSLPROGRAM
            #pragma vertex ParbakeShadowVertex
            #pragma fragment ParbakeShadow
            #pragma multi_compile _ _CASTING_PUNCTUAL_LIGHT_SHADOW
            #pragma multi_compile_instancing
            ENDHLSL
        }

        Pass
        {
            Name "DepthOnly"
            Tags { "LightMode" = "DepthOnly" }
            ColorMask R

            HLSLPROGRAM
            #pragma vertex ParbakeVertex
            #pragma fragment ParbakeDepth
            #pragma multi_compile_instancing
            ENDHLSL
        }

        Pass
        {
            Name "DepthNormals"
            Tags { "LightMode" = "DepthNormals" }

            HLSLPROGRAM
            #pragma vertex ParbakeVertex
            #pragma fragment ParbakeDepthNormals
            #pragma multi_compile_instancing
            ENDHLSL
        }
    }
}
