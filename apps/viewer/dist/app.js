import{LinearSRGBColorSpace as Vt,Mesh as Gt,OrthographicCamera as Ht,PlaneGeometry as qt,Scene as Kt,ShaderMaterial as Wt}from"./three.js";var w={first:0,second:1,split:2,side:3,difference:4},J=[["none","None"],["neutral","Khronos neutral"],["aces","ACES"]],F=["#0d0f1c","#45217a","#b5366e","#f07f3c","#fcf2a4"],ve=.25,G=a=>`vec3(${[1,3,5].map(e=>(parseInt(a.slice(e,e+2),16)/255).toFixed(4))})`,jt="varying vec2 at; void main() { at = uv; gl_Position = vec4(position.xy, 0.0, 1.0); }",Yt=`
uniform sampler2D first, second;
uniform float split, exposure;
uniform vec3 background, backgroundLight;
varying vec2 at;

vec3 encoded(vec3 c) {
  c = clamp(c, 0.0, 1.0);
  return mix(12.92 * c, 1.055 * pow(c, vec3(1.0 / 2.4)) - 0.055, step(0.0031308, c));
}
// Khronos PBR Neutral tone mapper, from its specification.
vec3 neutral(vec3 c) {
  float low = min(c.r, min(c.g, c.b)), offset = low < 0.08 ? low - 6.25 * low * low : 0.04;
  c -= offset;
  float peak = max(c.r, max(c.g, c.b)), start = 0.76;
  if (peak < start) return c;
  float d = 1.0 - start, top = 1.0 - d * d / (peak + d - start);
  c *= top / peak;
  return mix(c, vec3(top), 1.0 - 1.0 / (0.15 * (peak - top) + 1.0));
}
// Narkowicz' fit to the ACES curve.
vec3 aces(vec3 c) { return clamp(c * (2.51 * c + 0.03) / (c * (2.43 * c + 0.59) + 0.14), 0.0, 1.0); }

vec3 shown(vec4 c) {
  if (c.a == 0.0) return background;
#ifdef IS_COLOR
  vec3 light = c.rgb * exposure;
#if TONE == 1
  light = neutral(light / c.a) * c.a;
#elif TONE == 2
  light = aces(light / c.a) * c.a;
#endif
  return encoded(light + (1.0 - c.a) * backgroundLight);
#else
  return clamp(c.rgb + (1.0 - c.a) * background, 0.0, 1.0);
#endif
}
vec3 heat(float x) {
  vec3 c = mix(${G(F[0])}, ${G(F[1])}, clamp(4.0 * x, 0.0, 1.0));
  c = mix(c, ${G(F[2])}, clamp(4.0 * x - 1.0, 0.0, 1.0));
  c = mix(c, ${G(F[3])}, clamp(4.0 * x - 2.0, 0.0, 1.0));
  return mix(c, ${G(F[4])}, clamp(4.0 * x - 3.0, 0.0, 1.0));
}
void main() {
#if LAYOUT == ${w.first}
  vec3 c = shown(texture2D(first, at));
#elif LAYOUT == ${w.second}
  vec3 c = shown(texture2D(second, at));
#elif LAYOUT == ${w.split}
  vec3 c = shown(at.x < split ? texture2D(first, at) : texture2D(second, at));
#elif LAYOUT == ${w.side}
  vec2 half_ = vec2(fract(2.0 * at.x), at.y);
  vec3 c = shown(at.x < 0.5 ? texture2D(first, half_) : texture2D(second, half_));
#else
  vec3 d = shown(texture2D(first, at)) - shown(texture2D(second, at));
  vec3 c = heat(sqrt(dot(d, d) / 3.0) / ${ve.toFixed(4)});
#endif
  gl_FragColor = vec4(c, 1.0);
}`,Qt=a=>a>.04045?((a+.055)/1.055)**2.4:a/12.92,Z=class{constructor(e){e.outputColorSpace=Vt,this.renderer=e,this.uniforms={first:{value:null},second:{value:null},split:{value:.5},exposure:{value:1},background:{value:[0,0,0]},backgroundLight:{value:[0,0,0]}},this.materials={},this.scene=new Kt,this.quad=new Gt(new qt(2,2)),this.quad.frustumCulled=!1,this.scene.add(this.quad),this.camera=new Ht}material(e,t,r){let n=`${e} ${t} ${r}`;return this.materials[n]??=new Wt({defines:{LAYOUT:e,TONE:r,...t?{IS_COLOR:1}:{}},uniforms:this.uniforms,vertexShader:jt,fragmentShader:Yt,depthTest:!1,depthWrite:!1}),this.materials[n]}draw({layout:e,isColor:t,tone:r=0,...n},o=null){for(let[s,i]of Object.entries(n))this.uniforms[s].value=i;this.uniforms.backgroundLight.value=this.uniforms.background.value.map(Qt),this.quad.material=this.material(e,t,r),this.renderer.setRenderTarget(o),this.renderer.render(this.scene,this.camera)}};import{Matrix3 as sa}from"./three.js";import{DataTexture as Zt,FloatType as Jt,NearestFilter as ea,RGFormat as ta,Vector3 as _}from"./three.js";var S=32,I=512,N=(a,e,t)=>new _(a,e,t).normalize(),$=[[N(0,1,0),2,new _(.42,.44,.48)],[N(0,-1,0),2.5,new _(.14,.12,.1)],[N(.6,.7,.5),24,new _(4.6,4.4,4.1)],[N(-.9,.25,.35),16,new _(1.2,1.35,1.6)],[N(-.3,.45,-.85),30,new _(3.4,3.4,3.6)],[N(.95,.05,-.3),60,new _(4.2,3.8,3.2)]];function aa(a){let e=0;for(let t=0;t<32;t++)e=e*2+(a>>>t&1)>>>0;return e/4294967296}function ra(a,e){let t=Math.max(a,.001),r=Math.max(e,.02)**2,n=r*r,o=Math.sqrt(Math.max(0,1-t*t)),s=0,i=0;for(let l=0;l<I;l++){let h=na[l],u=Math.sqrt((1-h)/(1+(n-1)*h)),f=o*Math.sqrt(Math.max(0,1-u*u))*oa[l]+t*u,d=2*f*u-t;if(d<=0||f<=0)continue;let x=(O,y)=>O*Math.sqrt(y*y*(1-n)+n),v=.5/(x(d,t)+x(t,d))*d*4*f/u,M=(1-f)**5;s+=(1-M)*v,i+=M*v}return[s/I,i/I]}var na=Float64Array.from({length:I},(a,e)=>aa(e)),oa=Float64Array.from({length:I},(a,e)=>Math.cos(2*Math.PI*(e+.5)/I)),R=null;function Be(){if(R)return R;let a=new Float32Array(2*S*S);for(let e=0;e<S*S;e++)a.set(ra(e%S/(S-1),Math.floor(e/S)/(S-1)),2*e);return R=new Zt(a,S,S,ta,Jt),R.magFilter=R.minFilter=ea,R.needsUpdate=!0,R}var ze={pbAxis:{value:$.map(a=>a[0])},pbSharpness:{value:$.map(a=>a[1])},pbLamp:{value:$.map(a=>a[2])}},Xe=`
uniform vec3 pbAxis[${$.length}];
uniform float pbSharpness[${$.length}];
uniform vec3 pbLamp[${$.length}];
uniform highp sampler2D pbSplitSum;
uniform mat3 pbTurn;
const vec3 PB_AMBIENT = vec3(0.16, 0.165, 0.175);
const vec3 PB_SUN = vec3(0.95, 0.92, 0.86);
const vec3 PB_SUN_FROM = vec3(-0.2952407, 0.7873085, 0.5412746);

float pbIntegral(float sharpness) { return (1.0 - exp(-2.0 * sharpness)) * 6.28318531 / sharpness; }
float pbDiffuse(float lambda, float cosine) {
  float once = exp(-lambda), twice = exp(-2.0 * lambda);
  float scale = 1.0 + 2.0 * twice - 1.0 / lambda;
  float bias = (once - twice) / lambda - twice;
  float x = sqrt(max(1.0 - scale, 1e-6));
  float x0 = 0.36 * cosine, x1 = x / (4.0 * 0.36);
  float lit = abs(x0) <= x1 ? (x0 + x1) * (x0 + x1) / x : clamp(cosine, 0.0, 1.0);
  return max(lit * scale + bias, 0.0) * pbIntegral(lambda) / 3.14159265;
}
float pbSmoothed(float own, float cosine, float lobe) {
  float sharpness = lobe * own / (lobe + own);
  return exp(sharpness * (cosine - 1.0)) * pbIntegral(own) / pbIntegral(sharpness);
}
vec2 pbScaleAndBias(float cosine, float roughness) {
  vec2 place = clamp(vec2(cosine, roughness), 0.0, 1.0) * ${S-1}.0;
  ivec2 node = min(ivec2(place), ivec2(${S-2}));
  vec2 at = place - vec2(node);
  vec2 a = mix(texelFetch(pbSplitSum, node, 0).rg, texelFetch(pbSplitSum, node + ivec2(1, 0), 0).rg, at.x);
  vec2 b = mix(texelFetch(pbSplitSum, node + ivec2(0, 1), 0).rg, texelFetch(pbSplitSum, node + ivec2(1, 1), 0).rg, at.x);
  return mix(a, b, at.y);
}
vec3 pbShare(vec3 f0, float roughness, float grazing, vec2 table) {
  float lost = 1.0 - table.x - table.y;
  vec3 most = max(vec3(1.0 - roughness), f0);
  vec3 once = (f0 + (most - f0) * grazing) * table.x + table.y;
  vec3 mean = f0 + (1.0 - f0) / 21.0;
  return once + lost * once * mean / (1.0 - mean * lost);
}
float pbFifth(float x) { float square = x * x; return square * square * x; }
vec3 pbStudio(vec3 color, float metallic, float rough, float occlusion, vec3 emission, vec3 normal, vec3 viewer) {
  float roughness = clamp(rough, 0.0525, 1.0), alpha = roughness * roughness;
  float towards = dot(normal, viewer), cosine = clamp(towards, 1e-4, 1.0);
  vec3 mirrored = 2.0 * towards * normal - viewer;
  vec3 diffuse = PB_AMBIENT, reflected = PB_AMBIENT;
  float lobe = 0.5 / (alpha * alpha);
  for (int i = 0; i < ${$.length}; i++) {
    vec3 axis = pbTurn * pbAxis[i];
    diffuse += pbLamp[i] * pbDiffuse(pbSharpness[i], dot(axis, normal));
    reflected += pbLamp[i] * pbSmoothed(pbSharpness[i], dot(axis, mirrored), lobe);
  }
  vec2 table = pbScaleAndBias(cosine, roughness);
  float grazing = pbFifth(1.0 - cosine);
  vec3 dielectric = mix(diffuse * color, reflected, pbShare(vec3(0.04), roughness, grazing, table));
  vec3 metal = reflected * pbShare(color, roughness, grazing, table);
  vec3 light = mix(dielectric, metal, metallic) * occlusion + emission;
  vec3 sun = pbTurn * PB_SUN_FROM;
  float nl = dot(normal, sun);
  vec3 sum = sun + viewer;
  if (nl <= 0.0 || dot(sum, sum) < 1e-8) return light;
  vec3 h = normalize(sum), across = cross(normal, h);
  float nh = dot(normal, h), vh = dot(viewer, h), width = alpha * alpha;
  float spread = dot(across, across) + width * nh * nh;
  float masks = nl * sqrt(cosine * cosine * (1.0 - width) + width) + cosine * sqrt(nl * nl * (1.0 - width) + width);
  float specular = width / (3.14159265 * spread * spread) * 0.5 / masks;
  float schlick = pbFifth(max(1.0 - vh, 0.0));
  vec3 below = mix(color / 3.14159265, vec3(specular), 0.04 + 0.96 * schlick);
  return light + mix(below, specular * (color + (1.0 - color) * schlick), metallic) * PB_SUN * nl;
}
`;var D=[{key:"lit",label:"Lit",code:0,isColor:!0},{key:"base",label:"Base colour",code:1,isColor:!0},{key:"normal",label:"Normal",code:2},{key:"roughness",label:"Roughness",code:3},{key:"metallic",label:"Metallic",code:4},{key:"occlusion",label:"Occlusion",code:5},{key:"emission",label:"Emission",code:6,isColor:!0},{key:"opacity",label:"Opacity",code:7},{key:"checker",label:"UV checker",code:8}],L={three:0,studio:10,headlight:11},be={pbTurn:{value:new sa},pbSplitSum:{value:null},...ze},we=new Map,E=0;function Ve(a){if(a===L.studio&&(be.pbSplitSum.value=Be()),a!==E){E=a;for(let[e,t]of we)t>0&&(e.transmission=a===L.three?t:0),e.needsUpdate=!0}}function Ge(a){let[e,t]=[Math.cos(a),Math.sin(a)];be.pbTurn.value.set(e,0,t,0,1,0,-t,0,e)}var ia=`
varying vec2 pbUv;
vec3 pbChecker(vec2 uv) {
  vec2 at = floor(uv * 16.0), tile = fract(at / 16.0);
  vec3 hue = vec3(0.30 + 0.55 * tile.x, 0.38 + 0.4 * tile.y, 0.85 - 0.45 * tile.x);
  return mix(hue, hue * 0.55, mod(at.x + at.y, 2.0));
}
`,la={1:["diffuseColor.rgb","diffuseColor.rgb"],2:["pbNormal * 0.5 + 0.5","vec3(0.5, 0.5, 1.0)"],3:["vec3(roughnessFactor)","vec3(1.0)"],4:["vec3(metalnessFactor)","vec3(0.0)"],5:["vec3(pbOcclusion)","vec3(1.0)"],6:["totalEmissiveRadiance","vec3(0.0)"],7:["vec3(diffuseColor.a)","vec3(diffuseColor.a)"],8:["pbChecker(pbUv)","pbChecker(pbUv)"],10:["pbStudio(diffuseColor.rgb, metalnessFactor, roughnessFactor, pbOcclusion, totalEmissiveRadiance, pbNormal, pbViewer)","diffuseColor.rgb"],11:["max(dot(pbNormal, pbViewer), 0.0) * diffuseColor.rgb + totalEmissiveRadiance","diffuseColor.rgb"]},ca=(a,e)=>`
{
  #ifdef OPAQUE
    diffuseColor.a = 1.0;
  #endif
  ${e?`
  vec3 pbNormal = inverseTransformDirection(normal, viewMatrix);
  vec3 pbViewer = inverseTransformDirection(normalize(vViewPosition), viewMatrix);
  float pbOcclusion = 1.0;
  #ifdef USE_AOMAP
    pbOcclusion = (texture2D(aoMap, vAoMapUv).r - 1.0) * aoMapIntensity + 1.0;
  #endif`:""}
  gl_FragColor = vec4(${la[a][e?0:1]}, ${a===7||a===8?"1.0":"diffuseColor.a"});
  return;
}
`;function ha(a){if(Object.assign(a.uniforms,be),E===L.three)return;let e=["#include <lights_physical_fragment>","#include <opaque_fragment>"].find(n=>a.fragmentShader.includes(n)),t=e!=="#include <opaque_fragment>",r=(E===8?ia:"")+(E===L.studio?Xe:"");E===8&&(a.vertexShader=a.vertexShader.replace("void main() {",`varying vec2 pbUv;
void main() {
  pbUv = uv;`)),a.fragmentShader=a.fragmentShader.replace("void main() {",`${r}
void main() {`).replace(e,`${ca(E,t)}
${e}`)}function He(a){if(we.has(a)||!a.isMeshStandardMaterial&&!a.isMeshBasicMaterial)return;we.set(a,a.transmission??0);let{onBeforeCompile:e,customProgramCacheKey:t}=a;a.onBeforeCompile=function(r,n){ha(r),e.call(this,r,n)},a.customProgramCacheKey=function(){return`parbake ${E} ${t.call(this)}`}}var ye=[["map","Base colour"],["normalMap","Normal"],["roughnessMap","Roughness, metallic"],["metalnessMap","Roughness, metallic"],["aoMap","Occlusion"],["emissiveMap","Emission"],["clearcoatMap","Clearcoat"],["clearcoatRoughnessMap","Clearcoat roughness"],["clearcoatNormalMap","Clearcoat normal"],["sheenColorMap","Sheen"],["sheenRoughnessMap","Sheen roughness"],["transmissionMap","Transmission"],["thicknessMap","Thickness"],["specularColorMap","Specular colour"],["specularIntensityMap","Specular"],["iridescenceMap","Iridescence"],["iridescenceThicknessMap","Iridescence thickness"],["anisotropyMap","Anisotropy"]];import{BackSide as ua,BufferAttribute as fa,Color as da,DirectionalLight as pa,Mesh as ma,MeshBasicMaterial as xa,PMREMGenerator as ga,RoomEnvironment as va,Scene as wa,SphereGeometry as ba}from"./three.js";var U=[{key:"studio",label:"Studio, as in eval",shaded:L.studio},{key:"room",label:"Room",shaded:L.three},{key:"sky",label:"Evening sky",shaded:L.three},{key:"sun",label:"Sun",shaded:L.three},{key:"headlight",label:"Headlight, matte",shaded:L.headlight}];function ya(a){let e=new ba(10,64,32),{position:t}=e.attributes,r=[],n=new da;for(let s=0;s<t.count;s++)a(n,t.getX(s)/10,t.getY(s)/10,t.getZ(s)/10),r.push(n.r,n.g,n.b);e.setAttribute("color",new fa(new Float32Array(r),3));let o=new wa;return o.add(new ma(e,new xa({vertexColors:!0,side:ua}))),o}function Aa(a,e,t){let r=Math.min(1,Math.exp(-(((t-.12)/.12)**2))*(e>0?1:.2)),[n,o,s]=t>0?[.25,.42,.85]:[.12,.1,.08];a.setRGB(n+(5-n)*r,o+(3-o)*r,s+(1.6-s)*r)}function Ma(a,e,t){let r=Math.max(0,t);a.setRGB(.16+.1*r,.18+.14*r,.2+.24*r)}var ee=class{constructor(e,t){this.renderer=e,this.scenes=t,this.made={},this.suns=t.map(r=>{let n=new pa(16777215,2.6);return n.visible=!1,r.add(n,n.target),n})}environment(e){if(this.made[e])return this.made[e];let t=new ga(this.renderer),r=e==="room"?new va:ya(e==="sky"?Aa:Ma);return this.made[e]=t.fromScene(r,e==="room"?.04:.02).texture,t.dispose(),this.made[e]}choose(e,t){let n=e==="studio"||e==="headlight"?null:this.environment(e);this.scenes.forEach((o,s)=>{o.environment=n,o.environmentRotation.y=t;let i=this.suns[s];i.visible=e==="sun",i.position.set(Math.cos(-t)*3+Math.sin(t)*1.5,3,Math.sin(-t)*3+Math.cos(t)*1.5)})}};import{AnimationMixer as Wa,Box3 as ja,DRACOLoader as Ya,GLTFLoader as Qa,Group as Za,LoadingManager as Ja,MeshoptDecoder as er}from"./three.js";function Sa(a){let e=new DataView(a),t=e.getUint32(12,!0);return JSON.parse(new TextDecoder().decode(new Uint8Array(a,20,t)))}function qe(a){let{nodes:e=[],accessors:t=[]}=Sa(a);t.forEach((o,s)=>{if(o.bufferView===void 0&&o.count>1e7)throw new Error(`accessor ${s} declares ${o.count} elements without any bytes`)});let r=new Uint8Array(e.length),n=o=>[...e[o].children??[],...e[o].extensions?.MSFT_lod?.ids??[]];for(let o=0;o<e.length;o++){let s=r[o]?[]:[[o,n(o)]];for(;s.length;){let[i,l]=s.at(-1);r[i]=1;let h=l.pop();if(h===void 0)r[i]=2,s.pop();else if(h in e){if(r[h]===1)throw new Error(`node ${h} lies below itself`);r[h]||s.push([h,n(h)])}else throw new Error(`node ${i} names node ${h}, and there are ${e.length}`)}}}import{KTX2Loader as La}from"./three.js";var te=class extends La{constructor(e,t){super(e),this.broken=t}init(){return this.transcoderPending??=fetch("basis/basis_transcoder.wasm").then(e=>e.arrayBuffer()).then(e=>{this.workerPool.setWorkerCreator(()=>{let t=new Worker("basis/worker.js"),r=e.slice(0);return t.addEventListener("error",n=>this.broken(new Error(`KTX2: ${n.message}`))),t.postMessage({type:"init",config:this.workerConfig,transcoderBinary:r},[r]),t})}),this.transcoderPending}};import{ClampToEdgeWrapping as ot,LinearFilter as st,NoColorSpace as Ga,SRGBColorSpace as Ha,Vector3 as qa}from"./three.js";import{CustomBlending as Oa,MaxEquation as Fa,OneFactor as Me,Vector2 as Ra,Vector4 as _a,ZeroFactor as $a}from"./three.js";var Ca=`
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
`,Ke=`
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
${Ca}
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
`,We=`
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
      float parallaxWidth = clamp( fwidth( parallaxThere ), 1e-6, 1.0 );
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
`,je=`
#ifdef PARALLAX_OFFSET
  transformed += _parallax_offset;
#endif
`,ae=`
#ifdef PARALLAX_TANGENT
  vParallaxSide = tangent.w * sign( determinant( mat3( modelViewMatrix ) ) );
  #ifdef USE_INSTANCING
    vParallaxSide *= sign( determinant( mat3( instanceMatrix ) ) );
  #endif
  #ifdef USE_BATCHING
    vParallaxSide *= sign( determinant( mat3( batchingMatrix ) ) );
  #endif
#endif
`;var z="PARBAKE_materials_parallax";var B={shift:2,cutout:3},Ye=(a,e)=>Array.isArray(a)&&a.length===e&&a.every(Number.isFinite),Ae=a=>Number.isInteger(a?.index)&&a.index>=0;function Ta(a){if(a.version!==2)return`its version is ${a.version}, and this reads version 2`;let{cutout:e,limit:t,fadeFootprint:r}=a,n=e===void 0?[[a,B.shift]]:[[a,B.shift],[e,B.cutout]];for(let[o,s]of n){if(!Ae(o?.texture))return"a texture of it is missing";if(!Ye(o.scale,4*s)||!Ye(o.offset,4*s))return`it has not ${4*s} scales and offsets`}return t!==void 0&&!(t>0&&t<=1)?`its limit is ${t}`:r!==void 0&&!(r>0)?`its fade begins at ${r}`:null}function Qe(a,e){let t=a.extensions?.[z];if(!t)return null;let r=Ta(t);if(r)return e(`the parallax map of material "${a.name??""}" was left out: ${r}`),null;let{texture:n,scale:o,offset:s,limit:i=.25,fadeFootprint:l=1/0,cutout:h=null}=t;return{texture:n,scale:o,offset:s,limit:i,fadeFootprint:l,cutout:h}}function Ze(a){let{baseColorTexture:e,normalTexture:t}=a.extensions[z],r={...a};return Ae(e)&&(r.pbrMetallicRoughness={...a.pbrMetallicRoughness,baseColorTexture:e}),Ae(t)&&(r.normalTexture={...t,scale:a.normalTexture?.scale??1}),r}import{ShaderChunk as Ea}from"./three.js";var Pa=/texture2D\(\s*((?!lightMap\b)\w*[mM]ap),\s*(v\w+Uv)\b/g,Je=a=>a.replace(Pa,"parallaxTexture( $1, $2");function ka(a){return Je(a).replace(/#include <(\w+)>/g,(e,t)=>{let r=Ea[t]??"",n=Je(r);return n===r?e:n})}var X=a=>a.map(e=>`#define ${e}
`).join(""),P="_parallax_offset";function H(a){return a.replace("void main() {",`#ifdef PARALLAX_OFFSET
attribute vec3 ${P};
#endif
void main() {`).replace("#include <begin_vertex>",`#include <begin_vertex>
${je}`)}function re(a,e,t){let r=a.replace("#include <common>",`#include <common>
${Ke}`).replace("#include <map_fragment>",`${We}
#include <map_fragment>`);return e+(t?ka(r):r)}var ne=a=>Array.from({length:a.length/4},(e,t)=>new _a(...a.slice(4*t,4*t+4)));function et(a,e){let{height:t}=a.image;if(t%e)throw new Error(`an image of ${t} rows has no ${e} layers of one height`);return new Ra(t/e,t)}var q=class{constructor({texture:e,scale:t,offset:r,limit:n=.25,fadeFootprint:o=1/0,cutout:s=null}){this.textures=s?[e,s.texture]:[e],this.hasCutout=!!s,this.isFading=Number.isFinite(o),this.uniforms={parallaxMap:{value:e},parallaxScale:{value:ne(t)},parallaxOffset:{value:ne(r)},parallaxRows:{value:et(e,B.shift)},parallaxLimit:{value:n},parallaxFootprint:{value:o},parallaxIsMultisampled:{value:!1}},s&&Object.assign(this.uniforms,{parallaxCutoutMap:{value:s.texture},parallaxCutoutScale:{value:ne(s.scale)},parallaxCutoutOffset:{value:ne(s.offset)},parallaxCutoutRows:{value:et(s.texture,B.cutout)}})}},Le=class{#e=!0;constructor(e,t,r){this.material=e,this.maps=t,this.fallback={...r},this.followers=new Set,this.hasTangents=!1,this.hasOffsets=!1,this.isAnisotropic=tt(e)}get textures(){return[...this.maps.textures,...Object.values(this.fallback).filter(Boolean)]}get enabled(){return this.#e}set enabled(e){if(this.#e!==e){this.#e=e;for(let[t,r]of Object.entries(this.fallback))this.fallback[t]=this.material[t],this.material[t]=r;for(let t of this.followers)t.map=this.material.map;for(let t of[this.material,...this.followers])t.needsUpdate=!0}}get isActive(){return this.#e&&!!(this.material.map||this.material.normalMap)}},tt=({map:a,normalMap:e})=>a?.anisotropy>1||e?.anisotropy>1,at=a=>!!(a.normalMap||a.anisotropy>0);function Na(a,{material:e,maps:t,hasTangents:r,hasOffsets:n,isAnisotropic:o}){let s=!at(e)&&r,i=e.flatShading,l=!i&&(a.vertexTangents||s),h=["PARALLAX_SHIFT",t.hasCutout&&"PARALLAX_CUTOUT",t.isFading&&"PARALLAX_FADE",i&&"PARALLAX_FLAT",o&&"PARALLAX_ANISOTROPIC",n&&"PARALLAX_OFFSET",l&&"PARALLAX_TANGENT",s&&!i&&"USE_TANGENT"].filter(Boolean),u=`${X(h)}#define PARALLAX_UV ${e.map?"vMapUv":"vNormalMapUv"}
#define PARALLAX_IS_ORTHOGRAPHIC isOrthographic
`;a.vertexShader=X(h)+H(a.vertexShader).replace("void main() {",`${s?`attribute vec4 tangent;
`:""}#ifdef PARALLAX_TANGENT
varying float vParallaxSide;
#endif
void main() {`).replace("#include <normal_vertex>",`#include <normal_vertex>
${ae}`);let f=a.fragmentShader;if(t.hasCutout){let d=!e.transparent&&!(e.alphaTest>0)&&!e.alphaHash;f=f.replace("#include <map_fragment>",`float parallaxClipped = diffuseColor.a;
#include <map_fragment>`).replace("#include <alphahash_fragment>",`#include <alphahash_fragment>
#ifdef ALPHA_TO_COVERAGE
${d?"diffuseColor.a = parallaxClipped * parallaxCoverage;":"diffuseColor.a *= parallaxCoverage;"}
#endif`)}a.fragmentShader=re(f,u,!0)}var Se=new WeakMap;function Ia(a){let e=a.getRenderTarget();return e?e.samples>0:(Se.has(a)||Se.set(a,a.getContext().getContextAttributes().antialias),Se.get(a))}function oe(a,e,{alphaToCoverage:t=!0,fallback:r={}}={}){if(!a.isMeshStandardMaterial)throw new Error("Parallax maps are for MeshStandardMaterial and MeshPhysicalMaterial.");let n=new Le(a,e,r),{onBeforeCompile:o,customProgramCacheKey:s,onBeforeRender:i,clone:l}=a,h=Object.hasOwn(a,"customProgramCacheKey");return a.parallax=n,a.onBeforeCompile=function(u,f){o.call(this,u,f),Object.assign(u.uniforms,e.uniforms),n.isActive&&Na(u,n)},a.customProgramCacheKey=function(){let u=h?s.call(this):o.toString();if(!n.isActive)return u;let f=!this.transparent&&!(this.alphaTest>0)&&!this.alphaHash,d=[!!this.map,n.hasTangents,n.hasOffsets,n.isAnisotropic,e.hasCutout,e.isFading,f].map(Number).join("");return`${u} parallax ${d}`},a.onBeforeRender=function(u,f,d,x,...v){i.call(this,u,f,d,x,...v),e.hasCutout&&(e.uniforms.parallaxIsMultisampled.value=Ia(u));let M={hasTangents:!!x.attributes.tangent&&!at(this),isAnisotropic:tt(this),hasOffsets:!!x.attributes[P]};Object.entries(M).every(([O,y])=>n[O]===y)||(Object.assign(n,M),this.needsUpdate=!0)},a.clone=function(){let u=l.call(this);if(!u.parallax){let f=n.enabled?n.fallback:Object.fromEntries(Object.keys(n.fallback).map(d=>[d,a[d]]));n.enabled||Object.assign(u,n.fallback),oe(u,e,{alphaToCoverage:!1,fallback:f})}return u.parallax.enabled=n.enabled,u},e.hasCutout&&t&&!a.transparent&&(a.alphaToCoverage=!0,Object.assign(a,{blending:Oa,blendSrc:Me,blendDst:$a,blendSrcAlpha:Me,blendDstAlpha:Me,blendEquationAlpha:Fa})),a}function se(a){let{onBeforeCompile:e,customProgramCacheKey:t}=a,r=!0;return a.onBeforeCompile=function(n,o){e.call(this,n,o),r&&(n.vertexShader=X(["PARALLAX_OFFSET"])+H(n.vertexShader))},a.customProgramCacheKey=function(){return`${t.call(this)} offsets ${r}`},n=>{n!==r&&(r=n,a.needsUpdate=!0)}}function ie(a){let e=new Set;return a.traverse(t=>{for(let r of[t.material??[]].flat())r.parallax&&e.add(r)}),[...e]}function Ce(a,e){for(let t of ie(a))t.parallax.enabled=e}import{MeshDepthMaterial as Da,MeshDistanceMaterial as Ua,ShaderChunk as Te}from"./three.js";var Ba=["beginnormal_vertex","morphnormal_vertex","skinnormal_vertex","defaultnormal_vertex","normal_vertex"].map(a=>Te[a].replaceAll("normalMatrix","transpose( inverse( mat3( modelViewMatrix ) ) )")).join(`
`),za=/#ifdef USE_DISPLACEMENTMAP\s+(?:#include <\w+>\s+)+#endif/,rt=a=>!(a.alphaTest>0)&&!a.alphaHash;function Xa(a,e,{hasTangents:t,hasNormals:r,hasOffsets:n}){let{maps:o}=e.parallax,s=e.map??e.normalMap,i=!rt(e),l=r&&t,h=["PARALLAX_CUTOUT",i&&"PARALLAX_SHIFT",o.isFading&&"PARALLAX_FADE",!r&&"PARALLAX_FLAT",l&&"PARALLAX_TANGENT",l&&"USE_TANGENT",n&&"PARALLAX_OFFSET"].filter(Boolean),u=`uv${s.channel||""}`,f=X(h)+(e.map?`#define PARALLAX_UV vMapUv
`:`#define PARALLAX_UV vParallaxUv
`)+`#define PARALLAX_IS_ORTHOGRAPHIC ( vParallaxIsPerspective < 0.5 )
`,d=`varying vec3 vViewPosition;
varying float vParallaxIsPerspective;
${e.map?"":`varying vec2 vParallaxUv;
`}`,x=r?Ba:"";a.vertexShader=f+H(a.vertexShader).replace("#include <common>",`#include <common>
      ${d}
      ${r?Te.normal_pars_vertex:""}
      ${l?`attribute vec4 tangent;
varying float vParallaxSide;`:""}
      ${e.map?"":`uniform mat3 parallaxTransform;
${s.channel?`attribute vec2 ${u};`:""}`}`).replace(za,`${x}
${ae}`).replace("#include <project_vertex>",`#include <project_vertex>
      vViewPosition = - mvPosition.xyz;
      vParallaxIsPerspective = isPerspectiveMatrix( projectionMatrix ) ? 1.0 : 0.0;
      ${e.map?"":`vParallaxUv = ( parallaxTransform * vec3( ${u}, 1 ) ).xy;`}`);let v=re(a.fragmentShader,f,i).replace("#include <common>",`#include <common>
      ${d}
      ${r?Te.normal_pars_fragment:""}`);i||(v=v.replace("#include <map_fragment>","").replace("#include <alphatest_fragment>","")),a.fragmentShader=v}function Va(a,e,{isDistance:t=!1}={}){let r=t?new Ua:new Da,{attributes:n}=e,o={hasTangents:!!n.tangent,hasNormals:!!n.normal,hasOffsets:!!n[P]};return Object.assign(r,{map:a.map,alphaMap:a.alphaMap,alphaTest:a.alphaTest,side:a.side}),r.onBeforeCompile=s=>{let{parallax:i,map:l,normalMap:h}=a;Object.assign(s.uniforms,i.maps.uniforms,{parallaxTransform:{value:(l??h)?.matrix}}),i.isActive&&Xa(s,a,o)},r.customProgramCacheKey=()=>{let{parallax:s}=a,i=a.map??a.normalMap;return s.isActive?`parallax depth ${[o.hasTangents,o.hasNormals,o.hasOffsets,s.maps.isFading,rt(a),!!a.map].map(Number).join("")} ${i.channel}`:""},a.parallax.followers.add(r),r}function nt(a){let e=new Map;a.traverse(t=>{let{material:r,geometry:n}=t;if(!t.isMesh||!r?.parallax?.maps.hasCutout||t.customDepthMaterial)return;let o=[r.uuid,...["tangent","normal",P].map(s=>n.attributes[s]!==void 0)].join(" ");e.has(o)||e.set(o,[!1,!0].map(s=>Va(r,n,{isDistance:s}))),[t.customDepthMaterial,t.customDistanceMaterial]=e.get(o)})}var it=a=>console.warn(`${z}: ${a}`);function lt(a){let e=a.clone();return Object.assign(e,{colorSpace:Ga,premultiplyAlpha:!1,generateMipmaps:!1,anisotropy:1,channel:0,minFilter:st,magFilter:st,wrapS:ot,wrapT:ot})}function Ka(a){let e=new qa,t=new Map;a.traverse(r=>{let{geometry:n}=r,o=n?.attributes[P];if(!o)return;if(!t.has(n)){let i=0;for(let l=0;l<o.count;l++)i=Math.max(i,e.fromBufferAttribute(o,l).length());t.set(n,i),n.computeBoundingSphere(),n.boundingSphere.radius+=i,n.boundingBox?.expandByScalar(i)}if(!r.isSkinnedMesh)return;let{computeBoundingSphere:s}=r;r.computeBoundingSphere=function(){s.call(this),this.boundingSphere.radius+=t.get(n)}})}var K=class{constructor(e,{alphaToCoverage:t=!0,fallback:r=!1}={}){this.name=z,this.parser=e,this.options={alphaToCoverage:t},this.loadsFallback=r,this.maps=[],this.plain=[]}beforeRoot(){let{json:e}=this.parser;return this.maps=(e.materials??[]).map(t=>Qe(t,it)),this.plain=e.materials??[],e.materials&&(e.materials=e.materials.map((t,r)=>this.maps[r]?Ze(t):t)),null}loadMaterial(e){let t=this.maps[e];return t?this.#e(e,t):null}async#e(e,t){let{parser:r}=this,n=h=>h?r.getDependency("texture",h.index):null,[o,s,i]=await Promise.all([r.loadMaterial(e),n(t.texture),n(t.cutout?.texture)]),l=this.loadsFallback?await this.#t(this.plain[e]):{};try{if(!o.isMeshStandardMaterial)throw new Error("the material is not lit, and this reads lit ones");if(!s?.image||t.cutout&&!i?.image)throw new Error("an image of it cannot be read");let h=t.cutout&&{...t.cutout,texture:lt(i)};oe(o,new q({...t,texture:lt(s),cutout:h}),{...this.options,fallback:l})}catch(h){it(`the parallax map of material "${o.name}" was left out: ${h.message}`)}return o}async#t(e){let t=e.extensions[z],r={},n=[["map",t.baseColorTexture,e.pbrMetallicRoughness?.baseColorTexture,Ha],["normalMap",t.normalTexture,e.normalTexture]];return await Promise.all(n.filter(([,o,s])=>o&&s).map(([o,,s,i])=>this.parser.assignTexture(r,o,s,i))),r}afterRoot({scenes:e}){for(let t of e)Ka(t),nt(t);return null}};var tr="PARBAKE_materials_parallax_sh";async function ke(a){let e=fetch(a.notes).then(s=>s.json()).catch(()=>({})),t=await fetch(a.url).catch(()=>{throw new Error("parbake view no longer answers: it was ended, or its address has changed. Start it again.")});if(!t.ok)throw new Error((await e).error??`${a.name}: the viewer answered ${t.status}.`);let r=await t.arrayBuffer(),{warnings:n=[],bytes:o=r.byteLength}=await e;return{entry:a,bytes:r,size:o,notes:[...n]}}function ct(a){let e,t=new Promise((o,s)=>{e=s});t.catch(()=>{});let r=new Ya().setDecoderPath("draco/"),n=new te(void 0,e).detectSupport(a);return async({entry:o,bytes:s,size:i,notes:l})=>{let h=new Ja;h.onError=()=>{let f=`${o.name}: a texture could not be decoded; its material is shown without it.`;l.includes(f)||l.push(f)};let u=new Qa(h).setDRACOLoader(r).setKTX2Loader(n).setMeshoptDecoder(er).register(f=>new K(f,{fallback:!0}));try{qe(s);let f=await Promise.race([u.parseAsync(s,""),t]);return new Pe(o,f,await ar(f),i,l)}catch(f){throw new Error(`${o.name}: this file cannot be shown: ${f?.message??f}.`)}}}async function ar({parser:a,scene:e}){let t=[];e.traverse(n=>{let o=a.associations.get(n)?.nodes,s=o===void 0?null:a.json.nodes?.[o],i=s?.extensions?.MSFT_lod?.ids;Array.isArray(i)&&i.length&&n.parent&&t.push({object:n,ids:i,definition:s})});let r=[];for(let{object:n,ids:o,definition:s}of t){let i=await Promise.all(o.map(h=>a.getDependency("node",h)));for(let h of i)n.parent.add(h);let l=s.extras?.MSFT_screencoverage;r.push({objects:[n,...i],coverage:Array.isArray(l)?l:null})}return r}var Pe=class{constructor(e,t,r,n,o){this.name=e.name,this.bytes=n,this.notes=o,this.root=new Za().add(t.scene),this.clips=t.animations,this.mixer=this.clips.length?new Wa(t.scene):null,this.lodNodes=r,this.levels=Math.max(1,...r.map(i=>i.objects.length)),this.coverage=r[0]?.coverage??null,(t.parser.json.extensionsUsed??[]).includes(tr)&&o.push(`${this.name} has parallax maps of the older kind. This viewer shows the plain material, without their depth.`),this.prepare(),this.parallax=ie(this.root),this.showLevel(0)}prepare(){let e=0;this.hasTransmission=!1,this.hasExtensions=!1,this.root.traverse(t=>{t.isLight&&(t.visible=!1),(t.isPoints||t.isLine)&&e++;for(let r of Ee(t))He(r),r.transmission>0&&(this.hasTransmission=!0),r.isMeshPhysicalMaterial&&(this.hasExtensions=!0)}),e&&this.notes.push(`${this.name}: points and lines are shown, but not counted.`)}showLevel(e){for(let{objects:t}of this.lodNodes){let r=e===null?-1:Math.min(e,t.length-1);t.forEach((n,o)=>{n.visible=o===r})}}setParallax(e){Ce(this.root,e)}get showsMaps(){return this.parallax.some(e=>e.parallax.enabled)}get isCut(){return this.parallax.some(e=>e.parallax.enabled&&e.alphaToCoverage)}box(){return this.root.updateMatrixWorld(!0),new ja().setFromObject(this.root,!0)}figures(){let e={triangles:0,vertices:0,materials:0,textures:0,texels:0},t=new Set,r=new Map,n=new Set;this.root.traverseVisible(o=>{if(!o.isMesh)return;let{geometry:s}=o,i=s.attributes.position;if(!i)return;let l=o.isInstancedMesh?o.count:1;e.triangles+=(s.index?s.index.count:i.count)/3*l,n.has(i)||(e.vertices+=i.count),n.add(i);for(let h of Ee(o))t.add(h)});for(let o of t)for(let s of[...ye.map(([i])=>o[i]),...o.parallax?.textures??[]]){let i=s?.image;i&&r.set(s.source,(i.width||0)*(i.height||0))}e.materials=t.size,e.textures=r.size;for(let o of r.values())e.texels+=o;return e}textures(){let e=new Map;return this.root.traverse(t=>{if(t.isMesh)for(let r of Ee(t))for(let[n,o]of ye){let s=r[n];if(!s?.image)continue;let i=`${s.source.uuid} ${o}`;e.has(i)||e.set(i,{label:o,material:r.name,texture:s,meshes:new Set}),e.get(i).meshes.add(t)}}),[...e.values()]}meshes(){let e=[];return this.root.traverseVisible(t=>{t.isMesh&&e.push(t)}),e}};function Ee(a){return a.material?[a.material].flat():[]}function ht(a){let e=[];return{get:()=>a,set(t){let r=Object.keys(t).filter(n=>!Object.is(a[n],t[n]));if(r.length){a={...a,...t};for(let{keys:n,call:o}of[...e])n.some(s=>r.includes(s))&&o(a)}},on(t,r){e.push({keys:t,call:r}),r(a)}}}var le=class{constructor(e){this.models=e,this.count=e.length>1?e.length:e[0].levels,this.coverage=e.length>1?null:e[0].coverage,this.shown=0,this.figures=Array.from({length:this.count},(t,r)=>(this.show(r),e.length>1?e[r].figures():e[0].figures())),this.show(0)}show(e){this.shown=e,this.models.length>1?this.models.forEach((t,r)=>{t.root.visible=r===e}):this.models[0].showLevel(e)}model(){return this.models.length>1?this.models[this.shown??0]:this.models[0]}forSize(e,t,r){if(this.coverage){let o=Math.min(1,Math.PI/4*e*e/(t*r)),s=this.coverage.findIndex(i=>o>=i);return s>=0?Math.min(s,this.count-1):this.coverage.length>=this.count?null:this.count-1}let n=Math.floor(Math.log2(.5*Math.min(t,r)/e))+1;return Math.min(this.count-1,Math.max(0,n))}};var c=a=>document.getElementById(a);function W(a,e,t,r){for(let n of a.querySelectorAll("label"))n.remove();for(let[n,o]of t){let s=document.createElement("label"),i=document.createElement("input"),l=document.createElement("span");Object.assign(i,{type:"radio",name:e,value:n}),i.addEventListener("change",()=>r(n)),l.textContent=o,s.append(i,l),a.append(s)}}function V(a,e){for(let t of a.querySelectorAll("input"))t.checked=t.value===String(e)}function k(a,e){a.replaceChildren(...e.map(([t,r])=>new Option(r,t)))}var rr=new Intl.NumberFormat("en"),C=a=>rr.format(Math.round(a));function ut(a){let e=["B","kB","MB","GB"],t=Math.min(3,Math.floor(Math.log10(Math.max(1,a))/3)),r=a/1e3**t;return`${t===0||r>=100?Math.round(r):r>=10?r.toFixed(1):r.toFixed(2)} ${e[t]}`}var nr=140;function ft(a,e,t){let r=c("loupe");if(r.hidden=!t||e>nr,r.hidden)return;let n=c("loupe-canvas"),o=n.getContext("2d"),s=Math.max(1,Math.floor(n.width/Math.max(16,e*1.1))),i=n.width/s;o.imageSmoothingEnabled=!1;let l=Math.round((a.width-i)/2),h=Math.round((a.height-i)/2);o.drawImage(a,l,h,i,i,0,0,n.width,n.height),c("loupe-text").textContent=`enlarged ${s} times`}function dt(a,{turn:e,move:t,zoom:r,takesWheel:n=()=>!0}){let o=new Map,s=()=>{let l=[...o.values()],h=l.reduce((d,x)=>d+x.x,0)/l.length,u=l.reduce((d,x)=>d+x.y,0)/l.length,f=l.length>1?Math.hypot(l[0].x-l[1].x,l[0].y-l[1].y):0;return{x:h,y:u,spread:f}};a.addEventListener("pointerdown",l=>{a.setPointerCapture(l.pointerId),o.set(l.pointerId,{x:l.offsetX,y:l.offsetY}),a.classList.add("grabbed")}),a.addEventListener("pointermove",l=>{if(!o.has(l.pointerId))return;let h=s();o.set(l.pointerId,{x:l.offsetX,y:l.offsetY});let u=s(),f=u.x-h.x,d=u.y-h.y;o.size>1?(t(f,d),h.spread>0&&u.spread>0&&r(h.spread/u.spread,u.x,u.y)):l.buttons&6||l.shiftKey||l.ctrlKey||l.metaKey?t(f,d):e(f,d)});let i=l=>{o.delete(l.pointerId),o.size||a.classList.remove("grabbed")};a.addEventListener("pointerup",i),a.addEventListener("pointercancel",i),a.addEventListener("contextmenu",l=>l.preventDefault()),a.addEventListener("wheel",l=>{if(!n())return;l.preventDefault();let h=l.deltaMode===1?16:1;r(Math.exp(Math.max(-120,Math.min(120,l.deltaY*h))*.0018),l.offsetX,l.offsetY)},{passive:!1})}var or=[["page","As the page"],["black","Black"],["grey","Grey"],["white","White"]],pt=[["model","Model"],["high","High-poly"],["split","Split"],["side","Side by side"],["difference","Difference"],["uv","UV layout"]],mt=a=>!["model","uv"].includes(a);function xt(a){W(c("channels"),"channel",D.map(e=>[e.key,e.label]),e=>a.set({channel:e})),k(c("light"),U.map(e=>[e.key,e.label])),k(c("tone"),J),k(c("background"),or);for(let e of["light","tone","background"])c(e).addEventListener("change",t=>a.set({[e]:t.target.value}));for(let e of["wireframe","parallax","turntable","uvLines"])c(e).addEventListener("change",t=>a.set({[e]:t.target.checked}));for(let e of["turn","exposure"])c(e).addEventListener("input",t=>a.set({[e]:Number(t.target.value)}));a.on(["mode"],({mode:e})=>{V(c("modes"),e),c("uv-section").hidden=e!=="uv",c("divider").hidden=e!=="side";for(let t of document.querySelectorAll(".scene-only"))t.hidden=e==="uv"}),a.on(["channel"],({channel:e})=>V(c("channels"),e)),a.on(["light","tone","background"],e=>{for(let t of["light","tone","background"])c(t).value=e[t]}),a.on(["wireframe","parallax","turntable","uvLines"],e=>{for(let t of["wireframe","parallax","turntable","uvLines"])c(t).checked=e[t]}),a.on(["turn","exposure"],({turn:e,exposure:t})=>{c("turn").value=e,c("exposure").value=t,c("turn-value").textContent=`${e}°`,c("exposure-value").textContent=`${t>0?"+":""}${t} EV`})}function gt(a,e,t){let r=[["Triangles",o=>C(o.triangles)],["Vertices",o=>C(o.vertices)],["Draw calls",o=>o.drawCalls?C(o.drawCalls):"–"],["Materials",o=>C(o.materials)],["Textures",o=>C(o.textures)],["Texels",o=>C(o.texels)],["File",o=>ut(o.bytes)]],n=c("figures").tBodies[0];for(let o of c("figures").querySelectorAll(".second"))o.hidden=!e;n.replaceChildren(...[...r.map(([o,s])=>[o,s(a),e?s(e):null]),t].filter(Boolean).map(([o,...s])=>{let i=document.createElement("tr"),l=document.createElement("th");l.scope="row",l.textContent=o,i.append(l);for(let h of s)h!==null&&(i.insertCell().textContent=h);return i}))}function vt(a){c("notes-section").hidden=a.length===0,c("notes").replaceChildren(...a.map(e=>{let t=document.createElement("li");return t.textContent=e,t}))}import{Color as Mr,CustomBlending as Sr,DoubleSide as Lr,EqualDepth as Cr,FloatType as Tr,HalfFloatType as Er,MeshBasicMaterial as Lt,OneFactor as Ct,Scene as Tt,UnsignedByteType as Pr,Vector3 as Et,WebGLRenderer as kr,WebGLRenderTarget as Fe,ZeroFactor as Pt}from"./three.js";var ce=class{constructor(e){this.gl=e,this.extension=e.getExtension("EXT_disjoint_timer_query_webgl2"),this.pending=null,this.milliseconds=null}get isAvailable(){return this.extension!==null}run(e){let{gl:t,extension:r}=this;if(this.poll(),!r||this.pending)return e();let n=t.createQuery();t.beginQuery(r.TIME_ELAPSED_EXT,n),e(),t.endQuery(r.TIME_ELAPSED_EXT),this.pending=n}poll(){let{gl:e,extension:t,pending:r}=this;return!r||!e.getQueryParameter(r,e.QUERY_RESULT_AVAILABLE)?r!==null:(e.getParameter(t.GPU_DISJOINT_EXT)||(this.milliseconds=e.getQueryParameter(r,e.QUERY_RESULT)/1e6),e.deleteQuery(r),this.pending=null,!1)}};import{BufferAttribute as wt,BufferGeometry as sr,Color as ir,DataTexture as lr,LineSegments as cr,Mesh as hr,OrthographicCamera as ur,PlaneGeometry as fr,Scene as dr,ShaderMaterial as bt,SRGBColorSpace as pr,Vector2 as At}from"./three.js";var yt="varying vec2 at; void main() { at = uv; gl_Position = projectionMatrix * modelViewMatrix * vec4(position, 1.0); }",mr=`
uniform sampler2D map; uniform bool isColor; uniform float light; varying vec2 at;
void main() {
  vec3 c = texture2D(map, vec2(at.x, 1.0 - at.y)).rgb;
  if (isColor) c = mix(12.92 * c, 1.055 * pow(max(c, 0.0), vec3(1.0 / 2.4)) - 0.055, step(0.0031308, c));
  gl_FragColor = vec4(light * c, 1.0);
}`,xr="uniform vec3 ink; uniform float opacity; void main() { gl_FragColor = vec4(ink, opacity); }",gr=.55,vr=[1,.56,.3],he=class{constructor(){this.scene=new dr,this.camera=new ur(-1,1,1,-1,-1,1),this.center=new At(.5,.5),this.span=1.15,this.blank=new lr(new Uint8Array([128,128,128,255]),1,1),this.blank.needsUpdate=!0,this.paper=new bt({uniforms:{map:{value:this.blank},isColor:{value:!1},light:{value:1}},vertexShader:yt,fragmentShader:mr}),this.ink=new bt({uniforms:{ink:{value:new ir(...vr)},opacity:{value:1}},vertexShader:yt,fragmentShader:xr,depthTest:!1,depthWrite:!1,transparent:!0});let e=new hr(new fr(1,1),this.paper);e.position.set(.5,.5,-.5),this.scene.add(e),this.lines=[]}show(e,t){let{texture:r}=e??{};this.paper.uniforms.map.value=r??this.blank,this.paper.uniforms.isColor.value=r?.colorSpace===pr;for(let o of this.lines)this.scene.remove(o),o.geometry.dispose();this.lines=[];for(let o of e?e.meshes:t){let s=wr(o.geometry,r,this.ink);s&&this.lines.push(s)}this.lines.length&&this.scene.add(...this.lines);let n=this.lines.reduce((o,s)=>o+s.geometry.index.count/6,0);this.ink.uniforms.opacity.value=Math.max(.15,Math.min(.9,60/Math.sqrt(n+1)))}showLines(e){for(let t of this.lines)t.visible=e;this.paper.uniforms.light.value=e?gr:1}move(e,t,r){this.center.x-=e/r*this.span,this.center.y+=t/r*this.span}zoom(e,t,r){let n=Math.min(40,Math.max(.005,this.span*e)),o=this.span-n;this.center.x+=t*o,this.center.y-=r*o,this.span=n}fit(){this.center.set(.5,.5),this.span=1.15}at(e){let[t,r]=e>=1?[e,1]:[1,1/e],{x:n,y:o}=this.center,s=this.span/2;return Object.assign(this.camera,{left:n-t*s,right:n+t*s,top:o+r*s,bottom:o-r*s}),this.camera.updateProjectionMatrix(),this.camera}};function wr(a,e,t){let r=a.attributes[e?.channel?`uv${e.channel}`:"uv"];if(!r)return null;e?.updateMatrix();let n=new Float32Array(3*r.count),o=new At;for(let f=0;f<r.count;f++)o.fromBufferAttribute(r,f),e&&o.applyMatrix3(e.matrix),n.set([o.x,1-o.y,0],3*f);let{index:s}=a,i=Math.floor((s?s.count:r.count)/3),l=new Uint32Array(6*i);for(let f=0;f<i;f++){let[d,x,v]=[0,1,2].map(M=>s?s.getX(3*f+M):3*f+M);l.set([d,x,x,v,v,d],6*f)}let h=new sr;h.setAttribute("position",new wt(n,3)),h.setIndex(new wt(l,1));let u=new cr(h,t);return u.frustumCulled=!1,u.renderOrder=1,u}import{PerspectiveCamera as br,Vector3 as ue}from"./three.js";var Oe=43.602818,yr=400,Ar=.02,Mt=1.55,fe=class{constructor(){this.camera=new br(Oe,1,.05,50),this.azimuth=.5,this.elevation=.3,this.distance=3.5,this.target=new ue,this.radius=1}halfAngle(){return Oe/2*(Math.PI/180)}orbit(e,t){this.azimuth+=e,this.elevation=Math.min(Mt,Math.max(-Mt,this.elevation+t))}zoom(e){this.distance=Math.min(yr,Math.max(Ar,this.distance*e))}pan(e,t){let r=2*Math.tan(this.halfAngle())*this.distance,n=new ue().setFromMatrixColumn(this.camera.matrixWorld,0),o=new ue().setFromMatrixColumn(this.camera.matrixWorld,1);this.target.addScaledVector(n,-e*r).addScaledVector(o,t*r)}fit(){this.target.set(0,0,0),this.distance=this.radius/Math.sin(this.halfAngle())*1.08}pixels(e){let t=Math.max(this.distance,this.radius*1.0001);return e*this.radius/(Math.tan(this.halfAngle())*Math.sqrt(t*t-this.radius*this.radius))}setPixels(e,t){let r=t/(e*Math.tan(this.halfAngle()));this.distance=this.radius*Math.sqrt(1+r*r)}at(e){let{camera:t,distance:r}=this,n=new ue(Math.sin(this.azimuth)*Math.cos(this.elevation),Math.sin(this.elevation),Math.cos(this.azimuth)*Math.cos(this.elevation));t.aspect=e,t.fov=e>=1?Oe:2*Math.atan(Math.tan(this.halfAngle())/e)*(180/Math.PI),t.position.copy(this.target).addScaledVector(n,r),t.lookAt(this.target);let o=this.radius*1.5+this.target.length();return t.near=Math.max(r-o,r*.01,.001),t.far=r+o,t.updateProjectionMatrix(),t.updateMatrixWorld(),t}};function St(a,e){let t=0;for(let r=0;r<a.length;r+=4){let n=a[r]-e[r],o=a[r+1]-e[r+1],s=a[r+2]-e[r+2];t+=n*n+o*o+s*s}return 10*Math.log10(65025/(t/(a.length/4*3)))}var Or=9e6,Fr=4e6,de=class{constructor(e){this.canvas=e,this.renderer=new kr({canvas:e,antialias:!1,alpha:!1,powerPreference:"high-performance"}),this.renderer.setPixelRatio(1),this.renderer.info.autoReset=!0,this.composer=new Z(this.renderer),this.timer=new ce(this.renderer.getContext()),this.scenes=[new Tt,new Tt],this.lights=new ee(this.renderer,this.scenes),this.view=new fe,this.uv=new he,this.wire=new Lt({wireframe:!0,transparent:!0,opacity:.55,depthWrite:!1}),this.cover=new Lt({side:Lr,depthFunc:Cr,depthWrite:!1,blending:Sr,blendSrc:Pt,blendDst:Ct,blendSrcAlpha:Ct,blendDstAlpha:Pt}),this.cover.onBeforeCompile=t=>{t.fragmentShader="void main() { gl_FragColor = vec4(1.0); }"},se(this.cover),this.wireFollows=se(this.wire),this.targets=[null,null],this.measured=[null,null],this.levels=null,this.compare=null,this.drawCalls=[0,0],this.milliseconds=null}setModels(e,t){for(let[l,h]of[[this.scenes[0],e?.models??[]],[this.scenes[1],t?[t]:[]]])for(let u of h)l.add(u.root);this.levels=e,this.compare=t;let r=(t??e.models[0]).box(),n=r.getSize(new Et),o=r.getCenter(new Et),s=Math.max(n.x,n.y,n.z);if(!(s>0)||!Number.isFinite(s))throw new Error("The model has no size: all its vertices lie at one point.");let i=2/s;for(let l of[...e.models,t].filter(Boolean))l.root.scale.setScalar(i),l.root.position.copy(o).multiplyScalar(-i),l.root.updateMatrixWorld(!0);this.view.radius=i*n.length()/2,this.view.fit()}resize(){let{clientWidth:e,clientHeight:t}=this.canvas,r=Math.min(window.devicePixelRatio||1,Math.sqrt(Or/Math.max(1,e*t))),n=Math.max(1,Math.round(e*r)),o=Math.max(1,Math.round(t*r));return this.width===n&&this.height===o?!1:(Object.assign(this,{width:n,height:o,ratio:r}),this.renderer.setSize(n,o,!1),!0)}part(e){return e===w.side?[Math.max(1,Math.floor(this.width/2)),this.height]:[this.width,this.height]}target(e,t,r){let n=t*r>Fr?2:4,o=this.targets[e];return o?.samples!==n&&(o?.dispose(),o=new Fe(t,r,{type:Er,samples:n}),this.targets[e]=o),o.setSize(t,r),o}choose({light:e,channel:t,turn:r}){let n=D.find(i=>i.key===t),o=U.find(i=>i.key===e);this.lights.choose(e,r),Ge(r);let s=n.key==="lit"?o.shaded:n.code;return this.isShaded=s===L.three,Ve(s),n.isColor??!1}picture(e,t,r,{wireframe:n,ink:o,background:s}){let i=this.scenes[e],{renderer:l}=this,h=e===0?this.levels.models:[this.compare];i.background=this.isShaded&&h.some(u=>u.hasTransmission)?new Mr().setRGB(...s,"srgb"):null,l.setRenderTarget(t),l.setClearColor(0,0),l.autoClear=!0,Rr(h,n),l.render(i,r),this.drawCalls[e]=l.info.render.calls,t.samples>0&&h.some(u=>u.isCut)&&(Object.assign(this.cover,{polygonOffset:n,...kt}),this.over(i,r,this.cover)),n&&(this.wire.color.set(o),this.wireFollows(h.some(u=>u.showsMaps)),this.over(i,r,this.wire))}over(e,t,r){this.renderer.autoClear=!1,e.background=null,e.overrideMaterial=r,this.renderer.render(e,t),e.overrideMaterial=null,this.renderer.autoClear=!0}draw(e){let{layout:t,uv:r}=e;if(r)return this.drawUv(e);let n=this.choose(e),[o,s]=this.part(t),i=this.view.at(o/s),l={[w.first]:[0],[w.second]:[1]}[t]??[0,1],h=performance.now();for(let u of l){let f=()=>this.picture(u,this.target(u,o,s),i,e);u===l[0]?this.timer.run(f):f()}this.composer.draw({first:this.targets[0]?.texture??null,second:this.targets[1]?.texture??null,layout:t,isColor:n,tone:e.tone,split:e.split,exposure:e.exposure,background:e.background}),this.milliseconds=performance.now()-h}drawUv({background:e,uvLines:t}){let{renderer:r}=this,n=this.target(0,this.width,this.height);this.uv.showLines(t),r.setRenderTarget(n),r.setClearColor(0,0),r.render(this.uv.scene,this.uv.at(this.width/this.height)),this.composer.draw({first:n.texture,layout:w.first,isColor:!1,background:e})}async measure(e){let t=this.choose(e),[r,n]=this.part(e.layout),o=this.view.at(r/n),s=[];for(let l of[0,1]){let h=this.target(l,r,n);this.picture(l,h,o,{...e,wireframe:!1}),this.measured[l]??=new Fe(r,n,{type:Pr,depthBuffer:!1}),this.measured[l].setSize(r,n),this.composer.draw({first:h.texture,layout:w.first,isColor:t,tone:e.tone,exposure:e.exposure,background:e.background},this.measured[l]),s.push(new Uint8Array(4*r*n))}let i=l=>this.renderer.readRenderTargetPixelsAsync(this.measured[l],0,0,r,n,s[l]);return await Promise.all([i(0),i(1)]),St(s[0],s[1])}still({direction:e,size:t=256,supersample:r=2,radius:n=3.5,which:o=0,light:s="studio",channel:i="lit",background:l=0}){let h=this.choose({light:s,channel:i,turn:0}),u=t*r,f=new Fe(u,u,{type:Tr}),d=this.view.at(1).clone();d.position.set(...e).normalize().multiplyScalar(n),d.up.set(0,1,0),d.lookAt(0,0,0),d.near=.05,d.far=n+4,d.updateProjectionMatrix(),d.updateMatrixWorld(),this.picture(o,f,d,{wireframe:!1,background:[l,l,l]});let x=new Float32Array(4*u*u);this.renderer.readRenderTargetPixels(f,0,0,u,u,x),f.dispose();let v=new Uint8ClampedArray(4*t*t),M=1/(r*r),O=y=>h?y>.0031308?1.055*y**(1/2.4)-.055:12.92*y:y;for(let y=0;y<t;y++)for(let Y=0;Y<t;Y++){let xe=[0,0,0,0];for(let T=0;T<r;T++)for(let ge=0;ge<r;ge++){let Xt=4*((u-1-(y*r+T))*u+Y*r+ge);for(let Q=0;Q<4;Q++)xe[Q]+=x[Xt+Q]*M}let Ue=4*(y*t+Y);for(let T=0;T<3;T++)v[Ue+T]=255*O(xe[T]+(1-xe[3])*l);v[Ue+3]=255}return v}},kt={polygonOffsetFactor:1,polygonOffsetUnits:1};function Rr(a,e){for(let t of a)!t||t.isOffset===e||(t.isOffset=e,t.root.traverse(r=>{for(let n of[r.material??[]].flat())Object.assign(n,{polygonOffset:e,...kt})}))}function Re(a){return[1,3,5].map(e=>parseInt(a.slice(e,e+2),16)/255)}function Ot(a,e){let t=a.filter(d=>d.clips.length),r=[...new Set(t.flatMap(d=>d.clips.map((x,v)=>x.name||`Clip ${v+1}`)))],n=!1,o=0,s=0,i=0,l=()=>{for(let d of t)d.mixer.setTime(Math.min(s,i));c("time").value=i?s/i:0,c("time-value").textContent=`${s.toFixed(1)} s`,e()},h=d=>{i=0,s=0;for(let x of t){x.mixer.stopAllAction();let v=x.clips.find((M,O)=>(M.name||`Clip ${O+1}`)===d);v&&(x.mixer.clipAction(v).play(),i=Math.max(i,v.duration))}l()},u=d=>{n&&(s=i?(s+(d-o)/1e3)%i:0,o=d,l(),requestAnimationFrame(u))},f=d=>{d&&t.length&&!i&&h(c("clip").value),n=d&&t.length>0,c("play").setAttribute("aria-label",n?"Pause":"Play"),c("play-icon").setAttribute("href",n?"#icon-pause":"#icon-play"),o=performance.now(),n&&requestAnimationFrame(u),e()};return c("animation-section").hidden=t.length===0,t.length&&(k(c("clip"),r.map(d=>[d,d])),c("clip").addEventListener("change",d=>h(d.target.value)),c("play").addEventListener("click",()=>f(!n)),c("time").addEventListener("input",d=>{f(!1),i||h(c("clip").value),s=d.target.value*i,l()})),{isPlaying:()=>n,toggle:()=>f(!n)}}function Ft(a,e){document.addEventListener("keydown",o=>{if(o.ctrlKey||o.metaKey||o.altKey||c("help").open)return;let{target:s}=o;if(s===c("canvas")&&e(o))return o.preventDefault();if(s.matches('select, input[type="text"], input[type="number"]')||s.matches("input, button")&&[" ","Enter"].includes(o.key))return;let i=o.key.length===1?o.key.toLowerCase():o.key,l=a.find(([h])=>h.includes(i));l&&(o.preventDefault(),l[2](i))});let t=c("shortcuts"),r=(o,s)=>{let i=document.createElement("dt"),l=document.createElement("dd");for(let h of o){let u=document.createElement("kbd");u.textContent=h===" "?"Space":h.length===1?h.toUpperCase():h,i.append(u)}l.textContent=s,t.append(i,l)};r(["←","→","↑","↓"],"Turn, with the picture in focus"),r(["+","−"],"Zoom, with the picture in focus");for(let[o,s]of a)r(o,s);let n=c("help");c("help-open").addEventListener("click",()=>n.showModal()),c("help-close").addEventListener("click",()=>n.close()),n.addEventListener("click",o=>{o.target===n&&n.close()})}function Rt(a){let e=c("splitter"),t=r=>a.set({split:Math.min(.98,Math.max(.02,r))});e.addEventListener("pointerdown",r=>{e.setPointerCapture(r.pointerId),e.focus({focusVisible:!1}),r.preventDefault()}),e.addEventListener("pointermove",r=>{if(!e.hasPointerCapture(r.pointerId))return;let{left:n,width:o}=e.parentElement.getBoundingClientRect();t((r.clientX-n)/o)}),e.addEventListener("keydown",r=>{let n={ArrowLeft:-.02,ArrowRight:.02,ArrowDown:-.02,ArrowUp:.02,PageDown:-.1,PageUp:.1},{split:o}=a.get();if(r.key in n)t(o+n[r.key]);else if(r.key==="Home"||r.key==="End")t(r.key==="Home"?0:1);else return;r.preventDefault(),r.stopPropagation()}),a.on(["split","mode"],({split:r,mode:n})=>{e.hidden=n!=="split",e.style.left=`${100*r}%`,e.setAttribute("aria-valuenow",String(Math.round(100*r))),e.setAttribute("aria-valuetext",`${Math.round(100*r)} percent model`)})}function _t(a){let e=matchMedia("(prefers-color-scheme: dark)"),t=!1,r=()=>{t||a.set({theme:e.matches?"dark":"light"})};e.addEventListener("change",r),a.on(["theme"],({theme:n})=>{document.documentElement.dataset.theme=n}),r(),c("theme").addEventListener("click",()=>{t=!0,a.set({theme:a.get().theme==="dark"?"light":"dark"})})}var It=250,_r=8e3,$r=["mode","channel","wireframe","parallax","light","turn","exposure","tone","background","split","level","theme","uvLines"],p=ht({mode:"model",channel:"lit",wireframe:!1,parallax:!0,light:"studio",turn:0,exposure:0,tone:"none",background:"page",split:.5,level:"auto",turntable:!1,uvLines:!0,theme:"light",isReady:!1,hasCompare:!1}),$t=a=>getComputedStyle(document.documentElement).getPropertyValue(a).trim(),m,Ie,g=null,b=null,pe=0,j=0,me=0,Dt=0,De=[];function Ut(){let a=p.get(),e={page:Re($t("--viewport")),black:[0,0,0],white:[1,1,1],grey:Re("#bcbcbc")}[a.background];return{layout:{high:w.second,split:w.split,side:w.side,difference:w.difference}[a.mode]??w.first,uv:a.mode==="uv",channel:a.channel,light:a.light,turn:a.turn*Math.PI/180,wireframe:a.wireframe,ink:$t("--wire"),exposure:2**a.exposure,tone:J.findIndex(([t])=>t===a.tone),split:a.split,background:e,uvLines:a.uvLines}}function $e(){if(pe=0,!p.get().isReady)return;m.resize();let{level:a}=p.get(),e=Math.min(m.width,m.height),t=m.view.pixels(e),r=a==="auto"?g.forSize(t,m.width,m.height):a;r!==g.shown&&g.show(r),m.draw(Ut()),ft(c("canvas"),t,["model","high","split","difference"].includes(p.get().mode)),Dr(t,e),Ur(),clearTimeout(j),j=0,!Ie.isPlaying()&&!p.get().turntable&&(j=setTimeout(Nr,It))}async function Nr(){j=0;let a=++me,e=m.timer.poll();_e();let{mode:t,hasCompare:r}=p.get();if(r&&t!=="uv"){let n=await m.measure(Ut());if(a!==me)return;c("psnr").textContent=Number.isFinite(n)?`${n.toFixed(2)} dB`:"the same picture",c("reading").hidden=!1,_e()}e&&setTimeout(()=>{m.timer.poll(),_e()},It),Dt=a}async function Ir(){do await new Promise(a=>setTimeout(a,20));while(pe||j||Dt!==me)}function A(){me++,pe||(pe=requestAnimationFrame($e))}function Dr(a,e){let[t,r]=[12,e*8];c("size").value=1e3*Math.log(a/t)/Math.log(r/t),c("size-value").textContent=`${C(a)} px`,c("size").setAttribute("aria-valuetext",`${Math.round(a)} pixels`)}function Ur(){let{mode:a,hasCompare:e}=p.get(),t=["split","side"].includes(a),[r,n]=[c("label-first"),c("label-second")],o=g.count>1?g.shown===null?", too small to be drawn":`, level ${g.shown}`:"",s=g.shown===null?0:g.figures[g.shown].triangles;r.hidden=!(t||g.count>1)||a==="uv"||a==="high",r.textContent=`${g.model().name}${o} · ${C(s)} triangles`,n.hidden=!e||!(t||a==="high"),e&&(n.textContent=`${b.name} · ${C(b.known.triangles)} triangles`)}function _e(){let a={triangles:0,vertices:0,materials:0,textures:0,texels:0},e={...g.shown===null?a:g.figures[g.shown],bytes:g.model().bytes,drawCalls:m.drawCalls[0]},t=b&&{...b.known,bytes:b.bytes,drawCalls:m.drawCalls[1]},{timer:r,milliseconds:n}=m,o=r.isAvailable?["GPU time",r.milliseconds===null?"–":`${r.milliseconds.toFixed(2)} ms`]:["Frame",n===null?"–":`${n.toFixed(1)} ms`];gt(e,t,o)}function Br(){let a=[];for(let[e,t]of[["Model",g.model()],["High-poly",b]]){if(!t)continue;let r=t.textures();for(let n of r){let{width:o,height:s}=n.texture.image;a.push({model:t,entry:n,label:`${n.label}, ${o} × ${s} (${[e,n.material].filter(Boolean).join(", ")})`})}r.length||a.push({model:t,entry:null,label:`No texture (${e})`})}De=a,k(c("texture"),a.map((e,t)=>[t,e.label])),Bt(0)}function Bt(a){let{model:e,entry:t}=De[a];m.uv.show(t,e.meshes()),A()}function zt(a){c("message").hidden=!0,c("failure").hidden=!1,c("failure-text").textContent=a.message??String(a),document.body.classList.add("failed"),c("panel-toggle").hidden=!0}function zr(a){c("banner-text").textContent=a,c("banner").hidden=!1}function Xr(){let a=c("canvas"),e=()=>Math.min(a.clientWidth,a.clientHeight),t=()=>p.get().mode==="uv";dt(a,{turn(r,n){t()?m.uv.move(r,n,e()):m.view.orbit(-r*.008,n*.008),A()},move(r,n){t()?m.uv.move(r,n,e()):m.view.pan(r/e(),n/e()),A()},zoom(r,n,o){t()?m.uv.zoom(r,(n-a.clientWidth/2)/e(),(o-a.clientHeight/2)/e()):m.view.zoom(r),A()}}),a.addEventListener("dblclick",Ne);for(let r of["fit","fit-uv"])c(r).addEventListener("click",Ne);c("size").addEventListener("input",r=>{let n=Math.min(m.width,m.height),[o,s]=[12,n*8];m.view.setPixels(o*(s/o)**(r.target.value/1e3),n),A()}),c("texture").addEventListener("change",r=>Bt(Number(r.target.value))),new ResizeObserver(A).observe(a)}function Ne(){p.get().mode==="uv"?m.uv.fit():m.view.fit(),A()}function Vr({key:a}){let e=p.get().mode==="uv",t=.12,r={ArrowLeft:[-1,0],ArrowRight:[1,0],ArrowUp:[0,1],ArrowDown:[0,-1]};if(r[a]){let[n,o]=r[a];e?m.uv.move(-40*n,40*o,1e3):m.view.orbit(n*t,o*t)}else if(a==="+"||a==="="||a==="-"){let n=a==="-"?1.15:.8695652173913044;e?m.uv.zoom(n,0,0):m.view.zoom(n)}else return!1;return A(),!0}function Nt(a,e){let t=e.indexOf(p.get()[a]);p.set({[a]:e[(t+1)%e.length]})}function Gr(a){let e=n=>{document.body.classList.toggle("panel-closed",!n),c("panel-toggle").setAttribute("aria-expanded",String(n)),A()},t=()=>e(document.body.classList.contains("panel-closed"));c("panel-toggle").addEventListener("click",t),e(!matchMedia("(max-width: 760px)").matches);let r=n=>{if(g.count<2)return;let o=p.get().level==="auto"?g.shown??g.count-1:p.get().level;p.set({level:Math.min(g.count-1,Math.max(0,o+n))})};Ft([[a.map((n,o)=>String(o+1)),"Views, from left to right",n=>p.set({mode:a[Number(n)-1]})],[["c"],"Next channel",()=>Nt("channel",D.map(n=>n.key))],[["l"],"Next light",()=>Nt("light",U.map(n=>n.key))],[["w"],"Wireframe",()=>p.set({wireframe:!p.get().wireframe})],[["d"],"Parallax maps",()=>{c("parallax-switch").hidden||p.set({parallax:!p.get().parallax})}],[["r"],"Turntable",()=>p.set({turntable:!p.get().turntable})],[["f"],"Fit to view",Ne],[["[","]"],"Finer or coarser level of detail",n=>r(n==="["?-1:1)],[[" "],"Play or pause the animation",()=>Ie.toggle()],[["t"],"Light or dark",()=>c("theme").click()],[["p"],"Settings",t],[["?"],"This help",()=>c("help").showModal()]],Vr)}function Hr(){let a=0,e=t=>{p.get().turntable&&(m.view.orbit(Math.min(.1,(t-a)/1e3)*.6,0),a=t,A(),requestAnimationFrame(e))};p.on(["turntable"],({turntable:t})=>{a=performance.now(),t&&requestAnimationFrame(e)})}function qr(){let a=c("levels");a.hidden=g.count<2;let e=g.figures.map((t,r)=>[r,`${r}: ${C(t.triangles)}`]);W(a,"level",[["auto","By size"],...e],t=>p.set({level:t})),p.on(["level"],({level:t})=>V(a,t))}async function Kr(){let a=await fetch("session.json").then(r=>r.json()).catch(()=>{throw new Error("parbake view no longer answers: it was ended. Start it again.")}),e=a.models.filter(r=>r.role==="level"),t=a.models.find(r=>r.role==="compare");return c("version").textContent=`Parbake ${a.version}.`,c("title").textContent=e[0].name,c("subtitle").textContent=t?`compared with ${t.name}`:"",document.title=`${e[0].name} – Parbake`,c("message-text").textContent=`Reading ${e.map(r=>r.name).join(", ")}`,{files:e,other:t}}async function Wr({files:a,other:e}){let t=a.map(ke),r=e&&ke(e);for(let h of[...t,r])h?.catch(()=>{});try{m=new de(c("canvas"))}catch{throw new Error("This browser has no WebGL 2, or it is switched off. Turn on hardware acceleration, or use another browser.")}let n=ct(m.renderer),o=r?r.then(n).catch(h=>h):null,s=await Promise.all(t.map(h=>h.then(n))),i=await o,l=i instanceof Error?i.message:null;return b=l?null:i,g=new le(s),b&&(b.known=b.figures()),m.setModels(g,b),{models:[...s,b].filter(Boolean),problem:l}}function jr(a){Ie=Ot(a,A);let e=pt.filter(([t])=>b||!mt(t));W(c("modes"),"mode",e,t=>p.set({mode:t})),c("modes").disabled=!1,Rt(p),qr(),Xr(),Hr(),Gr(e.map(([t])=>t)),c("parallax-switch").hidden=!a.some(t=>t.parallax.length),p.on(["parallax"],({parallax:t})=>{for(let r of a)r.setParallax(t)}),p.set({isReady:!0,hasCompare:b!==null,mode:b?"split":"model"}),p.on(["mode","hasCompare"],({mode:t,hasCompare:r})=>{c("legend").hidden=t!=="difference",(!r||t==="uv")&&(c("reading").hidden=!0),t==="uv"&&!De.length&&Br(),V(c("modes"),t)}),p.on($r,A)}async function Yr(){xt(p),_t(p),c("legend-ramp").style.background=`linear-gradient(90deg, ${F.join(", ")})`,c("legend-most").textContent=`${Math.round(ve*255)} of 255 and more`,c("banner-close").addEventListener("click",()=>{c("banner").hidden=!0}),c("canvas").addEventListener("webglcontextlost",()=>{zt(new Error("The graphics processor has dropped this page, most likely for want of memory. Reload the page."))});let a=setTimeout(()=>{c("message-text").textContent+=". Large models take a while."},_r),{models:e,problem:t}=await Wr(await Kr());clearTimeout(a),jr(e);let r=()=>vt([...new Set([...e.flatMap(n=>n.notes),...t?[t]:[]])]);t&&zr(`The model is shown by itself: ${t}`),r(),$e(),c("message").hidden=!0,e.some(n=>n.hasExtensions)&&requestAnimationFrame(()=>setTimeout(()=>p.set({light:"room"}))),setTimeout(r,1e3),window.parbake={store:p,stage:m,redraw:A,settled:Ir,snapshot:()=>($e(),c("canvas").toDataURL())}}Yr().catch(zt);
