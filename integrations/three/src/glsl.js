// The formulas of the format in GLSL, and the lines that are put into three.js' shaders. All vectors are in view space.

/** Pure functions, which tests compare with numbers. */
export const FUNCTIONS = /* glsl */ `
// The line of sight in the frame (tangent, bitangent, normal): the same from either of its ends.
vec3 parallaxLine( vec3 toViewer, mat3 frame ) {
  vec3 w = toViewer * frame;
  return w.z < 0.0 ? - w : w;
}

// Four pairs of coefficients, of x, y, xz and yz.
vec2 parallaxShift( vec4 first, vec4 second, vec3 w, float limit ) {
  vec4 pairs = first + second * w.z;
  return ( pairs.xy * w.x + pairs.zw * w.y ) / max( w.z, limit );
}

// Twelve coefficients, of functions that are orthonormal over the hemisphere.
float parallaxOpacity( vec4 a, vec4 b, vec4 c, vec3 w ) {
  float z = w.z, square = z * z;
  vec2 two = vec2( w.x * w.x - w.y * w.y, 2.0 * w.x * w.y );
  vec2 three = vec2( w.x * two.x - w.y * two.y, w.x * two.y + w.y * two.x );
  vec4 rings = vec4( 1.0, 2.0 * z - 1.0, 6.0 * ( square - z ) + 1.0, ( 20.0 * z - 30.0 ) * square + 12.0 * z - 1.0 );
  vec4 first = vec4( w.xy, w.xy * ( z - 0.375 ) );
  return dot( a * vec4( 1.0, 1.7320508, 2.236068, 2.6457513 ), rings )
    + dot( b * vec4( 1.7320508, 1.7320508, 7.108338, 7.108338 ), first )
    + dot( c * vec4( 1.9364917, 1.9364917, 2.0916501, 2.0916501 ), vec4( two, three ) );
}

// How much of the map is left under a pixel that spans these gradients; z brings them to what they are face on.
float parallaxFade( vec2 dx, vec2 dy, float z, float footprint ) {
  return clamp( 2.0 - z * max( length( dx ), length( dy ) ) / footprint, 0.0, 1.0 );
}

// Four channels at t. Layers lie one below the other; rows are those of a layer and of the image.
vec4 parallaxLayer( sampler2D map, vec2 t, float layer, vec2 rows ) {
  float row = clamp( t.y * rows.x, 0.5, rows.x - 0.5 ) + layer * rows.x;
  return textureLod( map, vec2( t.x, row / rows.y ), 0.0 );
}

// side is TANGENT.w.
mat3 parallaxFrame( vec3 n, vec3 tangent, float side ) {
  vec3 t = normalize( tangent - n * dot( n, tangent ) );
  return mat3( t, cross( n, t ) * side, n );
}

// Of a mesh without tangents: t along u, b against v, which grows downwards.
mat3 parallaxDerivedFrame( vec3 n, vec3 position, vec2 uv ) {
  vec3 px = dFdx( position ), py = dFdy( position );
  vec2 ux = dFdx( uv ), uy = dFdy( uv );
  float side = sign( ux.x * uy.y - uy.x * ux.y );
  vec3 alongU = ( px * uy.y - py * ux.y ) * side, alongV = ( py * ux.x - px * uy.x ) * side;
  vec3 t = alongU - n * dot( n, alongU );
  t *= inversesqrt( max( dot( t, t ), 1e-30 ) );
  vec3 b = cross( n, t );
  return mat3( t, dot( b, alongV ) > 0.0 ? - b : b, n );
}
`;

/** Before main of every fragment shader. */
export const DECLARED = /* glsl */ `
uniform sampler2D parallaxMap;
uniform vec4 parallaxScale[ 2 ], parallaxOffset[ 2 ];
uniform vec2 parallaxRows;
uniform float parallaxLimit;
#ifdef PARALLAX_FADE
  uniform float parallaxFootprint;
#endif
#ifdef PARALLAX_CUTOUT
  uniform sampler2D parallaxCutoutMap;
  uniform vec4 parallaxCutoutScale[ 3 ], parallaxCutoutOffset[ 3 ];
  uniform vec2 parallaxCutoutRows;
  uniform bool parallaxIsMultisampled;
#endif
#ifdef PARALLAX_TANGENT
  varying float vParallaxSide;
#endif
${FUNCTIONS}
vec2 parallaxMoved = vec2( 0.0 );
float parallaxCoverage = 1.0;

// A map of the material where the shift leads, with the gradients that it would have without. Where nothing is
// anisotropic, the level of detail says the same in a third of the time, by software.
vec4 parallaxTexture( sampler2D map, vec2 uv ) {
  #ifdef PARALLAX_ANISOTROPIC
    return textureGrad( map, uv + parallaxMoved, dFdx( uv ), dFdy( uv ) );
  #else
    vec2 texels = vec2( textureSize( map, 0 ) ), dx = dFdx( uv ) * texels, dy = dFdy( uv ) * texels;
    return textureLod( map, uv + parallaxMoved, 0.5 * log2( max( max( dot( dx, dx ), dot( dy, dy ) ), 1e-20 ) ) );
  #endif
}
`;

/** In main, before the first map is fetched. Expects PARALLAX_UV and PARALLAX_IS_ORTHOGRAPHIC. */
export const BEGIN = /* glsl */ `
{
  vec2 parallaxAt = PARALLAX_UV;
  #ifdef PARALLAX_FLAT
    vec3 parallaxNormal = normalize( cross( dFdx( vViewPosition ), dFdy( vViewPosition ) ) );
    if ( ! gl_FrontFacing ) parallaxNormal = - parallaxNormal;
  #else
    vec3 parallaxNormal = normalize( vNormal );
  #endif
  // three.js turns normals over for faces that are seen from behind; the format does not.
  #ifdef FLIP_SIDED
    parallaxNormal = - parallaxNormal;
  #endif
  #ifdef PARALLAX_TANGENT
    mat3 parallaxAxes = parallaxFrame( parallaxNormal, vTangent, vParallaxSide );
  #else
    mat3 parallaxAxes = parallaxDerivedFrame( parallaxNormal, - vViewPosition, parallaxAt );
  #endif
  vec3 parallaxSight = parallaxLine( PARALLAX_IS_ORTHOGRAPHIC ? vec3( 0.0, 0.0, 1.0 ) : normalize( vViewPosition ), parallaxAxes );
  float parallaxLeft = 1.0;
  #ifdef PARALLAX_FADE
    parallaxLeft = parallaxFade( dFdx( parallaxAt ), dFdy( parallaxAt ), parallaxSight.z, parallaxFootprint );
  #endif
  #ifdef PARALLAX_CUTOUT
    float parallaxThere = 1.0 + parallaxLeft * ( parallaxOpacity(
      parallaxCutoutOffset[ 0 ] + parallaxCutoutScale[ 0 ] * parallaxLayer( parallaxCutoutMap, parallaxAt, 0.0, parallaxCutoutRows ),
      parallaxCutoutOffset[ 1 ] + parallaxCutoutScale[ 1 ] * parallaxLayer( parallaxCutoutMap, parallaxAt, 1.0, parallaxCutoutRows ),
      parallaxCutoutOffset[ 2 ] + parallaxCutoutScale[ 2 ] * parallaxLayer( parallaxCutoutMap, parallaxAt, 2.0, parallaxCutoutRows ),
      parallaxSight ) - 1.0 );
    #ifdef ALPHA_TO_COVERAGE
      // The width is taken before anything is discarded. It is bounded, for past the edge of a triangle it is any number.
      float parallaxWidth = clamp( fwidth( parallaxThere ), 1e-6, 10.0 );
      parallaxCoverage = parallaxIsMultisampled ? clamp( 0.5 + parallaxThere / parallaxWidth, 0.0, 1.0 ) : step( 0.0, parallaxThere );
      if ( parallaxCoverage <= 0.0 ) discard;
    #else
      if ( parallaxThere < 0.0 ) discard;
    #endif
  #endif
  #ifdef PARALLAX_SHIFT
    parallaxMoved = parallaxLeft * parallaxShift(
      parallaxOffset[ 0 ] + parallaxScale[ 0 ] * parallaxLayer( parallaxMap, parallaxAt, 0.0, parallaxRows ),
      parallaxOffset[ 1 ] + parallaxScale[ 1 ] * parallaxLayer( parallaxMap, parallaxAt, 1.0, parallaxRows ),
      parallaxSight, parallaxLimit );
  #endif
}
`;

/** In the vertex shader: a cutout cannot add, so the surface that it cuts reaches further than the one without. */
export const REACH = /* glsl */ `
#ifdef PARALLAX_OFFSET
  transformed += _parallax_offset;
#endif
`;

/** In the vertex shader, after the tangent is known. A mirrored mesh turns cross products over. */
export const SIDE = /* glsl */ `
#ifdef PARALLAX_TANGENT
  vParallaxSide = tangent.w * sign( determinant( mat3( modelViewMatrix ) ) );
  #ifdef USE_INSTANCING
    vParallaxSide *= sign( determinant( mat3( instanceMatrix ) ) );
  #endif
  #ifdef USE_BATCHING
    vParallaxSide *= sign( determinant( mat3( batchingMatrix ) ) );
  #endif
#endif
`;
