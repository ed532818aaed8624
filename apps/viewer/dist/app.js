import{LinearSRGBColorSpace as Vt,Mesh as Xt,OrthographicCamera as Gt,PlaneGeometry as Ht,Scene as qt,ShaderMaterial as jt}from"./three.js";var w={first:0,second:1,split:2,side:3,difference:4},Z=[["none","None"],["neutral","Khronos neutral"],["aces","ACES"]],O=["#0d0f1c","#45217a","#b5366e","#f07f3c","#fcf2a4"],ge=.25,X=a=>`vec3(${[1,3,5].map(e=>(parseInt(a.slice(e,e+2),16)/255).toFixed(4))})`,Wt="varying vec2 at; void main() { at = uv; gl_Position = vec4(position.xy, 0.0, 1.0); }",Kt=`
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
  vec3 c = mix(${X(O[0])}, ${X(O[1])}, clamp(4.0 * x, 0.0, 1.0));
  c = mix(c, ${X(O[2])}, clamp(4.0 * x - 1.0, 0.0, 1.0));
  c = mix(c, ${X(O[3])}, clamp(4.0 * x - 2.0, 0.0, 1.0));
  return mix(c, ${X(O[4])}, clamp(4.0 * x - 3.0, 0.0, 1.0));
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
  vec3 c = heat(sqrt(dot(d, d) / 3.0) / ${ge.toFixed(4)});
#endif
  gl_FragColor = vec4(c, 1.0);
}`,Yt=a=>a>.04045?((a+.055)/1.055)**2.4:a/12.92,Q=class{constructor(e){e.outputColorSpace=Vt,this.renderer=e,this.uniforms={first:{value:null},second:{value:null},split:{value:.5},exposure:{value:1},background:{value:[0,0,0]},backgroundLight:{value:[0,0,0]}},this.materials={},this.scene=new qt,this.quad=new Xt(new Ht(2,2)),this.quad.frustumCulled=!1,this.scene.add(this.quad),this.camera=new Gt}material(e,t,n){let r=`${e} ${t} ${n}`;return this.materials[r]??=new jt({defines:{LAYOUT:e,TONE:n,...t?{IS_COLOR:1}:{}},uniforms:this.uniforms,vertexShader:Wt,fragmentShader:Kt,depthTest:!1,depthWrite:!1}),this.materials[r]}draw({layout:e,isColor:t,tone:n=0,...r},o=null){for(let[s,i]of Object.entries(r))this.uniforms[s].value=i;this.uniforms.backgroundLight.value=this.uniforms.background.value.map(Yt),this.quad.material=this.material(e,t,n),this.renderer.setRenderTarget(o),this.renderer.render(this.scene,this.camera)}};import{Matrix3 as oa}from"./three.js";import{DataTexture as Qt,FloatType as Zt,NearestFilter as Jt,RGFormat as ea,Vector3 as _}from"./three.js";var S=32,I=512,N=(a,e,t)=>new _(a,e,t).normalize(),$=[[N(0,1,0),2,new _(.42,.44,.48)],[N(0,-1,0),2.5,new _(.14,.12,.1)],[N(.6,.7,.5),24,new _(4.6,4.4,4.1)],[N(-.9,.25,.35),16,new _(1.2,1.35,1.6)],[N(-.3,.45,-.85),30,new _(3.4,3.4,3.6)],[N(.95,.05,-.3),60,new _(4.2,3.8,3.2)]];function ta(a){let e=0;for(let t=0;t<32;t++)e=e*2+(a>>>t&1)>>>0;return e/4294967296}function aa(a,e){let t=Math.max(a,.001),n=Math.max(e,.02)**2,r=n*n,o=Math.sqrt(Math.max(0,1-t*t)),s=0,i=0;for(let l=0;l<I;l++){let h=na[l],u=Math.sqrt((1-h)/(1+(r-1)*h)),d=o*Math.sqrt(Math.max(0,1-u*u))*ra[l]+t*u,f=2*d*u-t;if(f<=0||d<=0)continue;let x=(F,y)=>F*Math.sqrt(y*y*(1-r)+r),v=.5/(x(f,t)+x(t,f))*f*4*d/u,M=(1-d)**5;s+=(1-M)*v,i+=M*v}return[s/I,i/I]}var na=Float64Array.from({length:I},(a,e)=>ta(e)),ra=Float64Array.from({length:I},(a,e)=>Math.cos(2*Math.PI*(e+.5)/I)),R=null;function Ue(){if(R)return R;let a=new Float32Array(2*S*S);for(let e=0;e<S*S;e++)a.set(aa(e%S/(S-1),Math.floor(e/S)/(S-1)),2*e);return R=new Qt(a,S,S,ea,Zt),R.magFilter=R.minFilter=Jt,R.needsUpdate=!0,R}var Be={pbAxis:{value:$.map(a=>a[0])},pbSharpness:{value:$.map(a=>a[1])},pbLamp:{value:$.map(a=>a[2])}},ze=`
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
`;var D=[{key:"lit",label:"Lit",code:0,isColor:!0},{key:"base",label:"Base colour",code:1,isColor:!0},{key:"normal",label:"Normal",code:2},{key:"roughness",label:"Roughness",code:3},{key:"metallic",label:"Metallic",code:4},{key:"occlusion",label:"Occlusion",code:5},{key:"emission",label:"Emission",code:6,isColor:!0},{key:"opacity",label:"Opacity",code:7},{key:"checker",label:"UV checker",code:8}],L={three:0,studio:10,headlight:11},we={pbTurn:{value:new oa},pbSplitSum:{value:null},...Be},ve=new Map,E=0;function Ve(a){if(a===L.studio&&(we.pbSplitSum.value=Ue()),a!==E){E=a;for(let[e,t]of ve)t>0&&(e.transmission=a===L.three?t:0),e.needsUpdate=!0}}function Xe(a){let[e,t]=[Math.cos(a),Math.sin(a)];we.pbTurn.value.set(e,0,t,0,1,0,-t,0,e)}var sa=`
varying vec2 pbUv;
vec3 pbChecker(vec2 uv) {
  vec2 at = floor(uv * 16.0), tile = fract(at / 16.0);
  vec3 hue = vec3(0.30 + 0.55 * tile.x, 0.38 + 0.4 * tile.y, 0.85 - 0.45 * tile.x);
  return mix(hue, hue * 0.55, mod(at.x + at.y, 2.0));
}
`,ia={1:["diffuseColor.rgb","diffuseColor.rgb"],2:["pbNormal * 0.5 + 0.5","vec3(0.5, 0.5, 1.0)"],3:["vec3(roughnessFactor)","vec3(1.0)"],4:["vec3(metalnessFactor)","vec3(0.0)"],5:["vec3(pbOcclusion)","vec3(1.0)"],6:["totalEmissiveRadiance","vec3(0.0)"],7:["vec3(diffuseColor.a)","vec3(diffuseColor.a)"],8:["pbChecker(pbUv)","pbChecker(pbUv)"],10:["pbStudio(diffuseColor.rgb, metalnessFactor, roughnessFactor, pbOcclusion, totalEmissiveRadiance, pbNormal, pbViewer)","diffuseColor.rgb"],11:["max(dot(pbNormal, pbViewer), 0.0) * diffuseColor.rgb + totalEmissiveRadiance","diffuseColor.rgb"]},la=(a,e)=>`
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
  gl_FragColor = vec4(${ia[a][e?0:1]}, ${a===7||a===8?"1.0":"diffuseColor.a"});
  return;
}
`;function ca(a){if(Object.assign(a.uniforms,we),E===L.three)return;let e=["#include <lights_physical_fragment>","#include <opaque_fragment>"].find(r=>a.fragmentShader.includes(r)),t=e!=="#include <opaque_fragment>",n=(E===8?sa:"")+(E===L.studio?ze:"");E===8&&(a.vertexShader=a.vertexShader.replace("void main() {",`varying vec2 pbUv;
void main() {
  pbUv = uv;`)),a.fragmentShader=a.fragmentShader.replace("void main() {",`${n}
void main() {`).replace(e,`${la(E,t)}
${e}`)}function Ge(a){if(ve.has(a)||!a.isMeshStandardMaterial&&!a.isMeshBasicMaterial)return;ve.set(a,a.transmission??0);let{onBeforeCompile:e,customProgramCacheKey:t}=a;a.onBeforeCompile=function(n,r){ca(n),e.call(this,n,r)},a.customProgramCacheKey=function(){return`parbake ${E} ${t.call(this)}`}}var be=[["map","Base colour"],["normalMap","Normal"],["roughnessMap","Roughness, metallic"],["metalnessMap","Roughness, metallic"],["aoMap","Occlusion"],["emissiveMap","Emission"],["clearcoatMap","Clearcoat"],["clearcoatRoughnessMap","Clearcoat roughness"],["clearcoatNormalMap","Clearcoat normal"],["sheenColorMap","Sheen"],["sheenRoughnessMap","Sheen roughness"],["transmissionMap","Transmission"],["thicknessMap","Thickness"],["specularColorMap","Specular colour"],["specularIntensityMap","Specular"],["iridescenceMap","Iridescence"],["iridescenceThicknessMap","Iridescence thickness"],["anisotropyMap","Anisotropy"]];import{BackSide as ha,BufferAttribute as ua,Color as da,DirectionalLight as fa,Mesh as pa,MeshBasicMaterial as ma,PMREMGenerator as xa,RoomEnvironment as ga,Scene as va,SphereGeometry as wa}from"./three.js";var U=[{key:"studio",label:"Studio, as in eval",shaded:L.studio},{key:"room",label:"Room",shaded:L.three},{key:"sky",label:"Evening sky",shaded:L.three},{key:"sun",label:"Sun",shaded:L.three},{key:"headlight",label:"Headlight, matte",shaded:L.headlight}];function ba(a){let e=new wa(10,64,32),{position:t}=e.attributes,n=[],r=new da;for(let s=0;s<t.count;s++)a(r,t.getX(s)/10,t.getY(s)/10,t.getZ(s)/10),n.push(r.r,r.g,r.b);e.setAttribute("color",new ua(new Float32Array(n),3));let o=new va;return o.add(new pa(e,new ma({vertexColors:!0,side:ha}))),o}function ya(a,e,t){let n=Math.min(1,Math.exp(-(((t-.12)/.12)**2))*(e>0?1:.2)),[r,o,s]=t>0?[.25,.42,.85]:[.12,.1,.08];a.setRGB(r+(5-r)*n,o+(3-o)*n,s+(1.6-s)*n)}function Aa(a,e,t){let n=Math.max(0,t);a.setRGB(.16+.1*n,.18+.14*n,.2+.24*n)}var J=class{constructor(e,t){this.renderer=e,this.scenes=t,this.made={},this.suns=t.map(n=>{let r=new fa(16777215,2.6);return r.visible=!1,n.add(r,r.target),r})}environment(e){if(this.made[e])return this.made[e];let t=new xa(this.renderer),n=e==="room"?new ga:ba(e==="sky"?ya:Aa);return this.made[e]=t.fromScene(n,e==="room"?.04:.02).texture,t.dispose(),this.made[e]}choose(e,t){let r=e==="studio"||e==="headlight"?null:this.environment(e);this.scenes.forEach((o,s)=>{o.environment=r,o.environmentRotation.y=t;let i=this.suns[s];i.visible=e==="sun",i.position.set(Math.cos(-t)*3+Math.sin(t)*1.5,3,Math.sin(-t)*3+Math.cos(t)*1.5)})}};import{AnimationMixer as ja,Box3 as Wa,DRACOLoader as Ka,GLTFLoader as Ya,Group as Qa,LoadingManager as Za,MeshoptDecoder as Ja}from"./three.js";function Ma(a){let e=new DataView(a),t=e.getUint32(12,!0);return JSON.parse(new TextDecoder().decode(new Uint8Array(a,20,t)))}function He(a){let{nodes:e=[],accessors:t=[]}=Ma(a);t.forEach((o,s)=>{if(o.bufferView===void 0&&o.count>1e7)throw new Error(`accessor ${s} declares ${o.count} elements without any bytes`)});let n=new Uint8Array(e.length),r=o=>[...e[o].children??[],...e[o].extensions?.MSFT_lod?.ids??[]];for(let o=0;o<e.length;o++){let s=n[o]?[]:[[o,r(o)]];for(;s.length;){let[i,l]=s.at(-1);n[i]=1;let h=l.pop();if(h===void 0)n[i]=2,s.pop();else if(h in e){if(n[h]===1)throw new Error(`node ${h} lies below itself`);n[h]||s.push([h,r(h)])}else throw new Error(`node ${i} names node ${h}, and there are ${e.length}`)}}}import{KTX2Loader as Sa}from"./three.js";var ee=class extends Sa{constructor(e,t){super(e),this.broken=t}init(){return this.transcoderPending??=fetch("basis/basis_transcoder.wasm").then(e=>e.arrayBuffer()).then(e=>{this.workerPool.setWorkerCreator(()=>{let t=new Worker("basis/worker.js"),n=e.slice(0);return t.addEventListener("error",r=>this.broken(new Error(`KTX2: ${r.message}`))),t.postMessage({type:"init",config:this.workerConfig,transcoderBinary:n},[n]),t})}),this.transcoderPending}};import{ClampToEdgeWrapping as rt,LinearFilter as ot,NoColorSpace as Xa,SRGBColorSpace as Ga,Vector3 as Ha}from"./three.js";import{CustomBlending as ka,MaxEquation as Fa,OneFactor as Ae,Vector2 as Oa,Vector4 as Ra,ZeroFactor as _a}from"./three.js";var La=`
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
`,qe=`
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
${La}
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
`,je=`
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
`,We=`
#ifdef PARALLAX_OFFSET
  transformed += _parallax_offset;
#endif
`,te=`
#ifdef PARALLAX_TANGENT
  vParallaxSide = tangent.w * sign( determinant( mat3( modelViewMatrix ) ) );
  #ifdef USE_INSTANCING
    vParallaxSide *= sign( determinant( mat3( instanceMatrix ) ) );
  #endif
  #ifdef USE_BATCHING
    vParallaxSide *= sign( determinant( mat3( batchingMatrix ) ) );
  #endif
#endif
`;var z="PARBAKE_materials_parallax";var B={shift:2,cutout:3},Ke=(a,e)=>Array.isArray(a)&&a.length===e&&a.every(Number.isFinite),ye=a=>Number.isInteger(a?.index)&&a.index>=0;function Ta(a){if(a.version!==2)return`its version is ${a.version}, and this reads version 2`;let{cutout:e,limit:t,fadeFootprint:n}=a,r=e===void 0?[[a,B.shift]]:[[a,B.shift],[e,B.cutout]];for(let[o,s]of r){if(!ye(o?.texture))return"a texture of it is missing";if(!Ke(o.scale,4*s)||!Ke(o.offset,4*s))return`it has not ${4*s} scales and offsets`}return t!==void 0&&!(t>0&&t<=1)?`its limit is ${t}`:n!==void 0&&!(n>0)?`its fade begins at ${n}`:null}function Ye(a,e){let t=a.extensions?.[z];if(!t)return null;let n=Ta(t);if(n)return e(`the parallax map of material "${a.name??""}" was left out: ${n}`),null;let{texture:r,scale:o,offset:s,limit:i=.25,fadeFootprint:l=1/0,cutout:h=null}=t;return{texture:r,scale:o,offset:s,limit:i,fadeFootprint:l,cutout:h}}function Qe(a){let{baseColorTexture:e,normalTexture:t}=a.extensions[z],n={...a};return ye(e)&&(n.pbrMetallicRoughness={...a.pbrMetallicRoughness,baseColorTexture:e}),ye(t)&&(n.normalTexture={...t,scale:a.normalTexture?.scale??1}),n}import{ShaderChunk as Ca}from"./three.js";var Ea=/texture2D\(\s*((?!lightMap\b)\w*[mM]ap),\s*(v\w+Uv)\b/g,Ze=a=>a.replace(Ea,"parallaxTexture( $1, $2");function Pa(a){return Ze(a).replace(/#include <(\w+)>/g,(e,t)=>{let n=Ca[t]??"",r=Ze(n);return r===n?e:r})}var G=a=>a.map(e=>`#define ${e}
`).join(""),P="_parallax_offset";function ae(a){return a.replace("void main() {",`#ifdef PARALLAX_OFFSET
attribute vec3 ${P};
#endif
void main() {`).replace("#include <begin_vertex>",`#include <begin_vertex>
${We}`)}function ne(a,e,t){let n=a.replace("#include <common>",`#include <common>
${qe}`).replace("#include <map_fragment>",`${je}
#include <map_fragment>`);return e+(t?Pa(n):n)}var re=a=>Array.from({length:a.length/4},(e,t)=>new Ra(...a.slice(4*t,4*t+4)));function Je(a,e){let{height:t}=a.image;if(t%e)throw new Error(`an image of ${t} rows has no ${e} layers of one height`);return new Oa(t/e,t)}var H=class{constructor({texture:e,scale:t,offset:n,limit:r=.25,fadeFootprint:o=1/0,cutout:s=null}){this.textures=s?[e,s.texture]:[e],this.hasCutout=!!s,this.isFading=Number.isFinite(o),this.uniforms={parallaxMap:{value:e},parallaxScale:{value:re(t)},parallaxOffset:{value:re(n)},parallaxRows:{value:Je(e,B.shift)},parallaxLimit:{value:r},parallaxFootprint:{value:o},parallaxIsMultisampled:{value:!1}},s&&Object.assign(this.uniforms,{parallaxCutoutMap:{value:s.texture},parallaxCutoutScale:{value:re(s.scale)},parallaxCutoutOffset:{value:re(s.offset)},parallaxCutoutRows:{value:Je(s.texture,B.cutout)}})}},Se=class{#e=!0;constructor(e,t,n){this.material=e,this.maps=t,this.fallback={...n},this.followers=new Set,this.hasTangents=!1,this.hasOffsets=!1,this.isAnisotropic=et(e)}get textures(){return[...this.maps.textures,...Object.values(this.fallback).filter(Boolean)]}get enabled(){return this.#e}set enabled(e){if(this.#e!==e){this.#e=e;for(let[t,n]of Object.entries(this.fallback))this.fallback[t]=this.material[t],this.material[t]=n;for(let t of[this.material,...this.followers])t.needsUpdate=!0}}get isActive(){return this.#e&&!!(this.material.map||this.material.normalMap)}},et=({map:a,normalMap:e})=>a?.anisotropy>1||e?.anisotropy>1,tt=a=>!!(a.normalMap||a.anisotropy>0);function $a(a,{material:e,maps:t,hasTangents:n,hasOffsets:r,isAnisotropic:o}){let s=!tt(e)&&n,i=e.flatShading,l=!i&&(a.vertexTangents||s),h=["PARALLAX_SHIFT",t.hasCutout&&"PARALLAX_CUTOUT",t.isFading&&"PARALLAX_FADE",i&&"PARALLAX_FLAT",o&&"PARALLAX_ANISOTROPIC",r&&"PARALLAX_OFFSET",l&&"PARALLAX_TANGENT",s&&!i&&"USE_TANGENT"].filter(Boolean),u=`${G(h)}#define PARALLAX_UV ${e.map?"vMapUv":"vNormalMapUv"}
#define PARALLAX_IS_ORTHOGRAPHIC isOrthographic
`;a.vertexShader=G(h)+ae(a.vertexShader).replace("void main() {",`${s?`attribute vec4 tangent;
`:""}#ifdef PARALLAX_TANGENT
varying float vParallaxSide;
#endif
void main() {`).replace("#include <normal_vertex>",`#include <normal_vertex>
${te}`);let d=a.fragmentShader;if(t.hasCutout){let f=!e.transparent&&!(e.alphaTest>0)&&!e.alphaHash;d=d.replace("#include <map_fragment>",`float parallaxClipped = diffuseColor.a;
#include <map_fragment>`).replace("#include <alphahash_fragment>",`#include <alphahash_fragment>
#ifdef ALPHA_TO_COVERAGE
${f?"diffuseColor.a = parallaxClipped * parallaxCoverage;":"diffuseColor.a *= parallaxCoverage;"}
#endif`)}a.fragmentShader=ne(d,u,!0)}var Me=new WeakMap;function Na(a){let e=a.getRenderTarget();return e?e.samples>0:(Me.has(a)||Me.set(a,a.getContext().getContextAttributes().antialias),Me.get(a))}function oe(a,e,{alphaToCoverage:t=!0,fallback:n={}}={}){if(!a.isMeshStandardMaterial)throw new Error("Parallax maps are for MeshStandardMaterial and MeshPhysicalMaterial.");let r=new Se(a,e,n),{onBeforeCompile:o,customProgramCacheKey:s,onBeforeRender:i,clone:l}=a,h=Object.hasOwn(a,"customProgramCacheKey");return a.parallax=r,a.onBeforeCompile=function(u,d){o.call(this,u,d),Object.assign(u.uniforms,e.uniforms),r.isActive&&$a(u,r)},a.customProgramCacheKey=function(){let u=h?s.call(this):o.toString();if(!r.isActive)return u;let d=!this.transparent&&!(this.alphaTest>0)&&!this.alphaHash,f=[!!this.map,r.hasTangents,r.hasOffsets,r.isAnisotropic,e.hasCutout,e.isFading,d].map(Number).join("");return`${u} parallax ${f}`},a.onBeforeRender=function(u,d,f,x,...v){i.call(this,u,d,f,x,...v),e.hasCutout&&(e.uniforms.parallaxIsMultisampled.value=Na(u));let M={hasTangents:!!x.attributes.tangent&&!tt(this),isAnisotropic:et(this),hasOffsets:!!x.attributes[P]};Object.entries(M).every(([F,y])=>r[F]===y)||(Object.assign(r,M),this.needsUpdate=!0)},a.clone=function(){let u=l.call(this);if(!u.parallax){let d=r.enabled?r.fallback:Object.fromEntries(Object.keys(r.fallback).map(f=>[f,a[f]]));r.enabled||Object.assign(u,r.fallback),oe(u,e,{alphaToCoverage:!1,fallback:d})}return u.parallax.enabled=r.enabled,u},e.hasCutout&&t&&!a.transparent&&(a.alphaToCoverage=!0,Object.assign(a,{blending:ka,blendSrc:Ae,blendDst:_a,blendSrcAlpha:Ae,blendDstAlpha:Ae,blendEquationAlpha:Fa})),a}function se(a){let e=new Set;return a.traverse(t=>{for(let n of[t.material??[]].flat())n.parallax&&e.add(n)}),[...e]}function Le(a,e){for(let t of se(a))t.parallax.enabled=e}import{MeshDepthMaterial as Ia,MeshDistanceMaterial as Da,ShaderChunk as Te}from"./three.js";var Ua=["beginnormal_vertex","morphnormal_vertex","skinnormal_vertex","defaultnormal_vertex","normal_vertex"].map(a=>Te[a].replaceAll("normalMatrix","transpose( inverse( mat3( modelViewMatrix ) ) )")).join(`
`),Ba=/#ifdef USE_DISPLACEMENTMAP\s+(?:#include <\w+>\s+)+#endif/,at=a=>!(a.alphaTest>0)&&!a.alphaHash;function za(a,e,{hasTangents:t,hasNormals:n,hasOffsets:r}){let{maps:o}=e.parallax,s=e.map??e.normalMap,i=!at(e),l=n&&t,h=["PARALLAX_CUTOUT",i&&"PARALLAX_SHIFT",o.isFading&&"PARALLAX_FADE",!n&&"PARALLAX_FLAT",l&&"PARALLAX_TANGENT",l&&"USE_TANGENT",r&&"PARALLAX_OFFSET"].filter(Boolean),u=`uv${s.channel||""}`,d=G(h)+(e.map?`#define PARALLAX_UV vMapUv
`:`#define PARALLAX_UV vParallaxUv
`)+`#define PARALLAX_IS_ORTHOGRAPHIC ( vParallaxIsPerspective < 0.5 )
`,f=`varying vec3 vViewPosition;
varying float vParallaxIsPerspective;
${e.map?"":`varying vec2 vParallaxUv;
`}`,x=n?Ua:"";a.vertexShader=d+ae(a.vertexShader).replace("#include <common>",`#include <common>
      ${f}
      ${n?Te.normal_pars_vertex:""}
      ${l?`attribute vec4 tangent;
varying float vParallaxSide;`:""}
      ${e.map?"":`uniform mat3 parallaxTransform;
${s.channel?`attribute vec2 ${u};`:""}`}`).replace(Ba,`${x}
${te}`).replace("#include <project_vertex>",`#include <project_vertex>
      vViewPosition = - mvPosition.xyz;
      vParallaxIsPerspective = isPerspectiveMatrix( projectionMatrix ) ? 1.0 : 0.0;
      ${e.map?"":`vParallaxUv = ( parallaxTransform * vec3( ${u}, 1 ) ).xy;`}`);let v=ne(a.fragmentShader,d,i).replace("#include <common>",`#include <common>
      ${f}
      ${n?Te.normal_pars_fragment:""}`);i||(v=v.replace("#include <map_fragment>","").replace("#include <alphatest_fragment>","")),a.fragmentShader=v}function Va(a,e,{isDistance:t=!1}={}){let n=t?new Da:new Ia,{attributes:r}=e,o={hasTangents:!!r.tangent,hasNormals:!!r.normal,hasOffsets:!!r[P]};return Object.assign(n,{map:a.map,alphaMap:a.alphaMap,alphaTest:a.alphaTest,side:a.side}),n.onBeforeCompile=s=>{let{parallax:i,map:l,normalMap:h}=a;Object.assign(s.uniforms,i.maps.uniforms,{parallaxTransform:{value:(l??h)?.matrix}}),i.isActive&&za(s,a,o)},n.customProgramCacheKey=()=>{let{parallax:s}=a,i=a.map??a.normalMap;return s.isActive?`parallax depth ${[o.hasTangents,o.hasNormals,o.hasOffsets,s.maps.isFading,at(a),!!a.map].map(Number).join("")} ${i.channel}`:""},a.parallax.followers.add(n),n}function nt(a){let e=new Map;a.traverse(t=>{let{material:n,geometry:r}=t;if(!t.isMesh||!n?.parallax?.maps.hasCutout||t.customDepthMaterial)return;let o=[n.uuid,...["tangent","normal",P].map(s=>r.attributes[s]!==void 0)].join(" ");e.has(o)||e.set(o,[!1,!0].map(s=>Va(n,r,{isDistance:s}))),[t.customDepthMaterial,t.customDistanceMaterial]=e.get(o)})}var st=a=>console.warn(`${z}: ${a}`);function it(a){let e=a.clone();return Object.assign(e,{colorSpace:Xa,premultiplyAlpha:!1,generateMipmaps:!1,anisotropy:1,channel:0,minFilter:ot,magFilter:ot,wrapS:rt,wrapT:rt})}function qa(a){let e=new Ha,t=new Set;a.traverse(({geometry:n})=>{let r=n?.attributes[P];if(!r||t.has(n))return;t.add(n);let o=0;for(let s=0;s<r.count;s++)o=Math.max(o,e.fromBufferAttribute(r,s).length());n.computeBoundingSphere(),n.boundingSphere.radius+=o,n.boundingBox?.expandByScalar(o)})}var q=class{constructor(e,{alphaToCoverage:t=!0,fallback:n=!1}={}){this.name=z,this.parser=e,this.options={alphaToCoverage:t},this.loadsFallback=n,this.maps=[],this.plain=[]}beforeRoot(){let{json:e}=this.parser;return this.maps=(e.materials??[]).map(t=>Ye(t,st)),this.plain=e.materials??[],e.materials&&(e.materials=e.materials.map((t,n)=>this.maps[n]?Qe(t):t)),null}loadMaterial(e){let t=this.maps[e];return t?this.#e(e,t):null}async#e(e,t){let{parser:n}=this,r=h=>h?n.getDependency("texture",h.index):null,[o,s,i]=await Promise.all([n.loadMaterial(e),r(t.texture),r(t.cutout?.texture)]),l=this.loadsFallback?await this.#t(this.plain[e]):{};try{if(!o.isMeshStandardMaterial)throw new Error("the material is not lit, and this reads lit ones");if(!s?.image||t.cutout&&!i?.image)throw new Error("an image of it cannot be read");let h=t.cutout&&{...t.cutout,texture:it(i)};oe(o,new H({...t,texture:it(s),cutout:h}),{...this.options,fallback:l})}catch(h){st(`the parallax map of material "${o.name}" was left out: ${h.message}`)}return o}async#t(e){let t=e.extensions[z],n={},r=[["map",t.baseColorTexture,e.pbrMetallicRoughness?.baseColorTexture,Ga],["normalMap",t.normalTexture,e.normalTexture]];return await Promise.all(r.filter(([,o,s])=>o&&s).map(([o,,s,i])=>this.parser.assignTexture(n,o,s,i))),n}afterRoot({scenes:e}){for(let t of e)qa(t),nt(t);return null}};var en="PARBAKE_materials_parallax_sh";async function Pe(a){let e=fetch(a.notes).then(s=>s.json()).catch(()=>({})),t=await fetch(a.url).catch(()=>{throw new Error("parbake view no longer answers: it was ended, or its address has changed. Start it again.")});if(!t.ok)throw new Error((await e).error??`${a.name}: the viewer answered ${t.status}.`);let n=await t.arrayBuffer(),{warnings:r=[],bytes:o=n.byteLength}=await e;return{entry:a,bytes:n,size:o,notes:[...r]}}function lt(a){let e,t=new Promise((o,s)=>{e=s});t.catch(()=>{});let n=new Ka().setDecoderPath("draco/"),r=new ee(void 0,e).detectSupport(a);return async({entry:o,bytes:s,size:i,notes:l})=>{let h=new Za;h.onError=()=>{let d=`${o.name}: a texture could not be decoded; its material is shown without it.`;l.includes(d)||l.push(d)};let u=new Ya(h).setDRACOLoader(n).setKTX2Loader(r).setMeshoptDecoder(Ja).register(d=>new q(d,{fallback:!0}));try{He(s);let d=await Promise.race([u.parseAsync(s,""),t]);return new Ee(o,d,await tn(d),i,l)}catch(d){throw new Error(`${o.name}: this file cannot be shown: ${d?.message??d}.`)}}}async function tn({parser:a,scene:e}){let t=[];e.traverse(r=>{let o=a.associations.get(r)?.nodes,s=o===void 0?null:a.json.nodes?.[o],i=s?.extensions?.MSFT_lod?.ids;Array.isArray(i)&&i.length&&r.parent&&t.push({object:r,ids:i,definition:s})});let n=[];for(let{object:r,ids:o,definition:s}of t){let i=await Promise.all(o.map(h=>a.getDependency("node",h)));for(let h of i)r.parent.add(h);let l=s.extras?.MSFT_screencoverage;n.push({objects:[r,...i],coverage:Array.isArray(l)?l:null})}return n}var Ee=class{constructor(e,t,n,r,o){this.name=e.name,this.bytes=r,this.notes=o,this.root=new Qa().add(t.scene),this.clips=t.animations,this.mixer=this.clips.length?new ja(t.scene):null,this.lodNodes=n,this.levels=Math.max(1,...n.map(i=>i.objects.length)),this.coverage=n[0]?.coverage??null,(t.parser.json.extensionsUsed??[]).includes(en)&&o.push(`${this.name} has parallax maps of the older kind. This viewer shows the plain material, without their depth.`),this.prepare(),this.parallax=se(this.root),this.showLevel(0)}prepare(){let e=0;this.hasTransmission=!1,this.hasExtensions=!1,this.root.traverse(t=>{t.isLight&&(t.visible=!1),(t.isPoints||t.isLine)&&e++;for(let n of Ce(t))Ge(n),n.transmission>0&&(this.hasTransmission=!0),n.isMeshPhysicalMaterial&&(this.hasExtensions=!0)}),e&&this.notes.push(`${this.name}: points and lines are shown, but not counted.`)}showLevel(e){for(let{objects:t}of this.lodNodes){let n=e===null?-1:Math.min(e,t.length-1);t.forEach((r,o)=>{r.visible=o===n})}}setParallax(e){Le(this.root,e)}get isCut(){return this.parallax.some(e=>e.parallax.enabled&&e.alphaToCoverage)}box(){return this.root.updateMatrixWorld(!0),new Wa().setFromObject(this.root,!0)}figures(){let e={triangles:0,vertices:0,materials:0,textures:0,texels:0},t=new Set,n=new Map,r=new Set;this.root.traverseVisible(o=>{if(!o.isMesh)return;let{geometry:s}=o,i=s.attributes.position;if(!i)return;let l=o.isInstancedMesh?o.count:1;e.triangles+=(s.index?s.index.count:i.count)/3*l,r.has(i)||(e.vertices+=i.count),r.add(i);for(let h of Ce(o))t.add(h)});for(let o of t)for(let s of[...be.map(([i])=>o[i]),...o.parallax?.textures??[]]){let i=s?.image;i&&n.set(s.source,(i.width||0)*(i.height||0))}e.materials=t.size,e.textures=n.size;for(let o of n.values())e.texels+=o;return e}textures(){let e=new Map;return this.root.traverse(t=>{if(t.isMesh)for(let n of Ce(t))for(let[r,o]of be){let s=n[r];if(!s?.image)continue;let i=`${s.source.uuid} ${o}`;e.has(i)||e.set(i,{label:o,material:n.name,texture:s,meshes:new Set}),e.get(i).meshes.add(t)}}),[...e.values()]}meshes(){let e=[];return this.root.traverseVisible(t=>{t.isMesh&&e.push(t)}),e}};function Ce(a){return a.material?[a.material].flat():[]}function ct(a){let e=[];return{get:()=>a,set(t){let n=Object.keys(t).filter(r=>!Object.is(a[r],t[r]));if(n.length){a={...a,...t};for(let{keys:r,call:o}of[...e])r.some(s=>n.includes(s))&&o(a)}},on(t,n){e.push({keys:t,call:n}),n(a)}}}var ie=class{constructor(e){this.models=e,this.count=e.length>1?e.length:e[0].levels,this.coverage=e.length>1?null:e[0].coverage,this.shown=0,this.figures=Array.from({length:this.count},(t,n)=>(this.show(n),e.length>1?e[n].figures():e[0].figures())),this.show(0)}show(e){this.shown=e,this.models.length>1?this.models.forEach((t,n)=>{t.root.visible=n===e}):this.models[0].showLevel(e)}model(){return this.models.length>1?this.models[this.shown??0]:this.models[0]}forSize(e,t,n){if(this.coverage){let o=Math.min(1,Math.PI/4*e*e/(t*n)),s=this.coverage.findIndex(i=>o>=i);return s>=0?Math.min(s,this.count-1):this.coverage.length>=this.count?null:this.count-1}let r=Math.floor(Math.log2(.5*Math.min(t,n)/e))+1;return Math.min(this.count-1,Math.max(0,r))}};var c=a=>document.getElementById(a);function j(a,e,t,n){for(let r of a.querySelectorAll("label"))r.remove();for(let[r,o]of t){let s=document.createElement("label"),i=document.createElement("input"),l=document.createElement("span");Object.assign(i,{type:"radio",name:e,value:r}),i.addEventListener("change",()=>n(r)),l.textContent=o,s.append(i,l),a.append(s)}}function V(a,e){for(let t of a.querySelectorAll("input"))t.checked=t.value===String(e)}function k(a,e){a.replaceChildren(...e.map(([t,n])=>new Option(n,t)))}var an=new Intl.NumberFormat("en"),T=a=>an.format(Math.round(a));function ht(a){let e=["B","kB","MB","GB"],t=Math.min(3,Math.floor(Math.log10(Math.max(1,a))/3)),n=a/1e3**t;return`${t===0||n>=100?Math.round(n):n>=10?n.toFixed(1):n.toFixed(2)} ${e[t]}`}var nn=140;function ut(a,e,t){let n=c("loupe");if(n.hidden=!t||e>nn,n.hidden)return;let r=c("loupe-canvas"),o=r.getContext("2d"),s=Math.max(1,Math.floor(r.width/Math.max(16,e*1.1))),i=r.width/s;o.imageSmoothingEnabled=!1;let l=Math.round((a.width-i)/2),h=Math.round((a.height-i)/2);o.drawImage(a,l,h,i,i,0,0,r.width,r.height),c("loupe-text").textContent=`enlarged ${s} times`}function dt(a,{turn:e,move:t,zoom:n,takesWheel:r=()=>!0}){let o=new Map,s=()=>{let l=[...o.values()],h=l.reduce((f,x)=>f+x.x,0)/l.length,u=l.reduce((f,x)=>f+x.y,0)/l.length,d=l.length>1?Math.hypot(l[0].x-l[1].x,l[0].y-l[1].y):0;return{x:h,y:u,spread:d}};a.addEventListener("pointerdown",l=>{a.setPointerCapture(l.pointerId),o.set(l.pointerId,{x:l.offsetX,y:l.offsetY}),a.classList.add("grabbed")}),a.addEventListener("pointermove",l=>{if(!o.has(l.pointerId))return;let h=s();o.set(l.pointerId,{x:l.offsetX,y:l.offsetY});let u=s(),d=u.x-h.x,f=u.y-h.y;o.size>1?(t(d,f),h.spread>0&&u.spread>0&&n(h.spread/u.spread,u.x,u.y)):l.buttons&6||l.shiftKey||l.ctrlKey||l.metaKey?t(d,f):e(d,f)});let i=l=>{o.delete(l.pointerId),o.size||a.classList.remove("grabbed")};a.addEventListener("pointerup",i),a.addEventListener("pointercancel",i),a.addEventListener("contextmenu",l=>l.preventDefault()),a.addEventListener("wheel",l=>{if(!r())return;l.preventDefault();let h=l.deltaMode===1?16:1;n(Math.exp(Math.max(-120,Math.min(120,l.deltaY*h))*.0018),l.offsetX,l.offsetY)},{passive:!1})}var rn=[["page","As the page"],["black","Black"],["grey","Grey"],["white","White"]],ft=[["model","Model"],["high","High-poly"],["split","Split"],["side","Side by side"],["difference","Difference"],["uv","UV layout"]],pt=a=>!["model","uv"].includes(a);function mt(a){j(c("channels"),"channel",D.map(e=>[e.key,e.label]),e=>a.set({channel:e})),k(c("light"),U.map(e=>[e.key,e.label])),k(c("tone"),Z),k(c("background"),rn);for(let e of["light","tone","background"])c(e).addEventListener("change",t=>a.set({[e]:t.target.value}));for(let e of["wireframe","parallax","turntable","uvLines"])c(e).addEventListener("change",t=>a.set({[e]:t.target.checked}));for(let e of["turn","exposure"])c(e).addEventListener("input",t=>a.set({[e]:Number(t.target.value)}));a.on(["mode"],({mode:e})=>{V(c("modes"),e),c("uv-section").hidden=e!=="uv",c("divider").hidden=e!=="side";for(let t of document.querySelectorAll(".scene-only"))t.hidden=e==="uv"}),a.on(["channel"],({channel:e})=>V(c("channels"),e)),a.on(["light","tone","background"],e=>{for(let t of["light","tone","background"])c(t).value=e[t]}),a.on(["wireframe","parallax","turntable","uvLines"],e=>{for(let t of["wireframe","parallax","turntable","uvLines"])c(t).checked=e[t]}),a.on(["turn","exposure"],({turn:e,exposure:t})=>{c("turn").value=e,c("exposure").value=t,c("turn-value").textContent=`${e}°`,c("exposure-value").textContent=`${t>0?"+":""}${t} EV`})}function xt(a,e,t){let n=[["Triangles",o=>T(o.triangles)],["Vertices",o=>T(o.vertices)],["Draw calls",o=>o.drawCalls?T(o.drawCalls):"–"],["Materials",o=>T(o.materials)],["Textures",o=>T(o.textures)],["Texels",o=>T(o.texels)],["File",o=>ht(o.bytes)]],r=c("figures").tBodies[0];for(let o of c("figures").querySelectorAll(".second"))o.hidden=!e;r.replaceChildren(...[...n.map(([o,s])=>[o,s(a),e?s(e):null]),t].filter(Boolean).map(([o,...s])=>{let i=document.createElement("tr"),l=document.createElement("th");l.scope="row",l.textContent=o,i.append(l);for(let h of s)h!==null&&(i.insertCell().textContent=h);return i}))}function gt(a){c("notes-section").hidden=a.length===0,c("notes").replaceChildren(...a.map(e=>{let t=document.createElement("li");return t.textContent=e,t}))}import{Color as Mn,CustomBlending as Sn,DoubleSide as Ln,EqualDepth as Tn,FloatType as Cn,HalfFloatType as En,MeshBasicMaterial as St,OneFactor as Lt,Scene as Tt,UnsignedByteType as Pn,Vector3 as Ct,WebGLRenderer as kn,WebGLRenderTarget as Fe,ZeroFactor as Et}from"./three.js";var le=class{constructor(e){this.gl=e,this.extension=e.getExtension("EXT_disjoint_timer_query_webgl2"),this.pending=null,this.milliseconds=null}get isAvailable(){return this.extension!==null}run(e){let{gl:t,extension:n}=this;if(this.poll(),!n||this.pending)return e();let r=t.createQuery();t.beginQuery(n.TIME_ELAPSED_EXT,r),e(),t.endQuery(n.TIME_ELAPSED_EXT),this.pending=r}poll(){let{gl:e,extension:t,pending:n}=this;return!n||!e.getQueryParameter(n,e.QUERY_RESULT_AVAILABLE)?n!==null:(e.getParameter(t.GPU_DISJOINT_EXT)||(this.milliseconds=e.getQueryParameter(n,e.QUERY_RESULT)/1e6),e.deleteQuery(n),this.pending=null,!1)}};import{BufferAttribute as vt,BufferGeometry as on,Color as sn,DataTexture as ln,LineSegments as cn,Mesh as hn,OrthographicCamera as un,PlaneGeometry as dn,Scene as fn,ShaderMaterial as wt,SRGBColorSpace as pn,Vector2 as yt}from"./three.js";var bt="varying vec2 at; void main() { at = uv; gl_Position = projectionMatrix * modelViewMatrix * vec4(position, 1.0); }",mn=`
uniform sampler2D map; uniform bool isColor; uniform float light; varying vec2 at;
void main() {
  vec3 c = texture2D(map, vec2(at.x, 1.0 - at.y)).rgb;
  if (isColor) c = mix(12.92 * c, 1.055 * pow(max(c, 0.0), vec3(1.0 / 2.4)) - 0.055, step(0.0031308, c));
  gl_FragColor = vec4(light * c, 1.0);
}`,xn="uniform vec3 ink; uniform float opacity; void main() { gl_FragColor = vec4(ink, opacity); }",gn=.55,vn=[1,.56,.3],ce=class{constructor(){this.scene=new fn,this.camera=new un(-1,1,1,-1,-1,1),this.center=new yt(.5,.5),this.span=1.15,this.blank=new ln(new Uint8Array([128,128,128,255]),1,1),this.blank.needsUpdate=!0,this.paper=new wt({uniforms:{map:{value:this.blank},isColor:{value:!1},light:{value:1}},vertexShader:bt,fragmentShader:mn}),this.ink=new wt({uniforms:{ink:{value:new sn(...vn)},opacity:{value:1}},vertexShader:bt,fragmentShader:xn,depthTest:!1,depthWrite:!1,transparent:!0});let e=new hn(new dn(1,1),this.paper);e.position.set(.5,.5,-.5),this.scene.add(e),this.lines=[]}show(e,t){let{texture:n}=e??{};this.paper.uniforms.map.value=n??this.blank,this.paper.uniforms.isColor.value=n?.colorSpace===pn;for(let o of this.lines)this.scene.remove(o),o.geometry.dispose();this.lines=[];for(let o of e?e.meshes:t){let s=wn(o.geometry,n,this.ink);s&&this.lines.push(s)}this.lines.length&&this.scene.add(...this.lines);let r=this.lines.reduce((o,s)=>o+s.geometry.index.count/6,0);this.ink.uniforms.opacity.value=Math.max(.15,Math.min(.9,60/Math.sqrt(r+1)))}showLines(e){for(let t of this.lines)t.visible=e;this.paper.uniforms.light.value=e?gn:1}move(e,t,n){this.center.x-=e/n*this.span,this.center.y+=t/n*this.span}zoom(e,t,n){let r=Math.min(40,Math.max(.005,this.span*e)),o=this.span-r;this.center.x+=t*o,this.center.y-=n*o,this.span=r}fit(){this.center.set(.5,.5),this.span=1.15}at(e){let[t,n]=e>=1?[e,1]:[1,1/e],{x:r,y:o}=this.center,s=this.span/2;return Object.assign(this.camera,{left:r-t*s,right:r+t*s,top:o+n*s,bottom:o-n*s}),this.camera.updateProjectionMatrix(),this.camera}};function wn(a,e,t){let n=a.attributes[e?.channel?`uv${e.channel}`:"uv"];if(!n)return null;e?.updateMatrix();let r=new Float32Array(3*n.count),o=new yt;for(let d=0;d<n.count;d++)o.fromBufferAttribute(n,d),e&&o.applyMatrix3(e.matrix),r.set([o.x,1-o.y,0],3*d);let{index:s}=a,i=Math.floor((s?s.count:n.count)/3),l=new Uint32Array(6*i);for(let d=0;d<i;d++){let[f,x,v]=[0,1,2].map(M=>s?s.getX(3*d+M):3*d+M);l.set([f,x,x,v,v,f],6*d)}let h=new on;h.setAttribute("position",new vt(r,3)),h.setIndex(new vt(l,1));let u=new cn(h,t);return u.frustumCulled=!1,u.renderOrder=1,u}import{PerspectiveCamera as bn,Vector3 as he}from"./three.js";var ke=43.602818,yn=400,An=.02,At=1.55,ue=class{constructor(){this.camera=new bn(ke,1,.05,50),this.azimuth=.5,this.elevation=.3,this.distance=3.5,this.target=new he,this.radius=1}halfAngle(){return ke/2*(Math.PI/180)}orbit(e,t){this.azimuth+=e,this.elevation=Math.min(At,Math.max(-At,this.elevation+t))}zoom(e){this.distance=Math.min(yn,Math.max(An,this.distance*e))}pan(e,t){let n=2*Math.tan(this.halfAngle())*this.distance,r=new he().setFromMatrixColumn(this.camera.matrixWorld,0),o=new he().setFromMatrixColumn(this.camera.matrixWorld,1);this.target.addScaledVector(r,-e*n).addScaledVector(o,t*n)}fit(){this.target.set(0,0,0),this.distance=this.radius/Math.sin(this.halfAngle())*1.08}pixels(e){let t=Math.max(this.distance,this.radius*1.0001);return e*this.radius/(Math.tan(this.halfAngle())*Math.sqrt(t*t-this.radius*this.radius))}setPixels(e,t){let n=t/(e*Math.tan(this.halfAngle()));this.distance=this.radius*Math.sqrt(1+n*n)}at(e){let{camera:t,distance:n}=this,r=new he(Math.sin(this.azimuth)*Math.cos(this.elevation),Math.sin(this.elevation),Math.cos(this.azimuth)*Math.cos(this.elevation));t.aspect=e,t.fov=e>=1?ke:2*Math.atan(Math.tan(this.halfAngle())/e)*(180/Math.PI),t.position.copy(this.target).addScaledVector(r,n),t.lookAt(this.target);let o=this.radius*1.5+this.target.length();return t.near=Math.max(n-o,n*.01,.001),t.far=n+o,t.updateProjectionMatrix(),t.updateMatrixWorld(),t}};function Mt(a,e){let t=0;for(let n=0;n<a.length;n+=4){let r=a[n]-e[n],o=a[n+1]-e[n+1],s=a[n+2]-e[n+2];t+=r*r+o*o+s*s}return 10*Math.log10(65025/(t/(a.length/4*3)))}var Fn=9e6,On=4e6,de=class{constructor(e){this.canvas=e,this.renderer=new kn({canvas:e,antialias:!1,alpha:!1,powerPreference:"high-performance"}),this.renderer.setPixelRatio(1),this.renderer.info.autoReset=!0,this.composer=new Q(this.renderer),this.timer=new le(this.renderer.getContext()),this.scenes=[new Tt,new Tt],this.lights=new J(this.renderer,this.scenes),this.view=new ue,this.uv=new ce,this.wire=new St({wireframe:!0,transparent:!0,opacity:.55,depthWrite:!1}),this.cover=new St({side:Ln,depthFunc:Tn,depthWrite:!1,blending:Sn,blendSrc:Et,blendDst:Lt,blendSrcAlpha:Lt,blendDstAlpha:Et}),this.cover.onBeforeCompile=t=>{t.fragmentShader="void main() { gl_FragColor = vec4(1.0); }"},this.targets=[null,null],this.measured=[null,null],this.levels=null,this.compare=null,this.drawCalls=[0,0],this.milliseconds=null}setModels(e,t){for(let[l,h]of[[this.scenes[0],e?.models??[]],[this.scenes[1],t?[t]:[]]])for(let u of h)l.add(u.root);this.levels=e,this.compare=t;let n=(t??e.models[0]).box(),r=n.getSize(new Ct),o=n.getCenter(new Ct),s=Math.max(r.x,r.y,r.z);if(!(s>0)||!Number.isFinite(s))throw new Error("The model has no size: all its vertices lie at one point.");let i=2/s;for(let l of[...e.models,t].filter(Boolean))l.root.scale.setScalar(i),l.root.position.copy(o).multiplyScalar(-i),l.root.updateMatrixWorld(!0);this.view.radius=i*r.length()/2,this.view.fit()}resize(){let{clientWidth:e,clientHeight:t}=this.canvas,n=Math.min(window.devicePixelRatio||1,Math.sqrt(Fn/Math.max(1,e*t))),r=Math.max(1,Math.round(e*n)),o=Math.max(1,Math.round(t*n));return this.width===r&&this.height===o?!1:(Object.assign(this,{width:r,height:o,ratio:n}),this.renderer.setSize(r,o,!1),!0)}part(e){return e===w.side?[Math.max(1,Math.floor(this.width/2)),this.height]:[this.width,this.height]}target(e,t,n){let r=t*n>On?2:4,o=this.targets[e];return o?.samples!==r&&(o?.dispose(),o=new Fe(t,n,{type:En,samples:r}),this.targets[e]=o),o.setSize(t,n),o}choose({light:e,channel:t,turn:n}){let r=D.find(i=>i.key===t),o=U.find(i=>i.key===e);this.lights.choose(e,n),Xe(n);let s=r.key==="lit"?o.shaded:r.code;return this.isShaded=s===L.three,Ve(s),r.isColor??!1}picture(e,t,n,{wireframe:r,ink:o,background:s}){let i=this.scenes[e],{renderer:l}=this,h=e===0?this.levels.models:[this.compare];i.background=this.isShaded&&h.some(u=>u.hasTransmission)?new Mn().setRGB(...s,"srgb"):null,l.setRenderTarget(t),l.setClearColor(0,0),l.autoClear=!0,Rn(h,r),l.render(i,n),this.drawCalls[e]=l.info.render.calls,t.samples>0&&h.some(u=>u.isCut)&&(Object.assign(this.cover,{polygonOffset:r,...Pt}),this.over(i,n,this.cover)),r&&(this.wire.color.set(o),this.over(i,n,this.wire))}over(e,t,n){this.renderer.autoClear=!1,e.background=null,e.overrideMaterial=n,this.renderer.render(e,t),e.overrideMaterial=null,this.renderer.autoClear=!0}draw(e){let{layout:t,uv:n}=e;if(n)return this.drawUv(e);let r=this.choose(e),[o,s]=this.part(t),i=this.view.at(o/s),l={[w.first]:[0],[w.second]:[1]}[t]??[0,1],h=performance.now();for(let u of l){let d=()=>this.picture(u,this.target(u,o,s),i,e);u===l[0]?this.timer.run(d):d()}this.composer.draw({first:this.targets[0]?.texture??null,second:this.targets[1]?.texture??null,layout:t,isColor:r,tone:e.tone,split:e.split,exposure:e.exposure,background:e.background}),this.milliseconds=performance.now()-h}drawUv({background:e,uvLines:t}){let{renderer:n}=this,r=this.target(0,this.width,this.height);this.uv.showLines(t),n.setRenderTarget(r),n.setClearColor(0,0),n.render(this.uv.scene,this.uv.at(this.width/this.height)),this.composer.draw({first:r.texture,layout:w.first,isColor:!1,background:e})}async measure(e){let t=this.choose(e),[n,r]=this.part(e.layout),o=this.view.at(n/r),s=[];for(let l of[0,1]){let h=this.target(l,n,r);this.picture(l,h,o,{...e,wireframe:!1}),this.measured[l]??=new Fe(n,r,{type:Pn,depthBuffer:!1}),this.measured[l].setSize(n,r),this.composer.draw({first:h.texture,layout:w.first,isColor:t,tone:e.tone,exposure:e.exposure,background:e.background},this.measured[l]),s.push(new Uint8Array(4*n*r))}let i=l=>this.renderer.readRenderTargetPixelsAsync(this.measured[l],0,0,n,r,s[l]);return await Promise.all([i(0),i(1)]),Mt(s[0],s[1])}still({direction:e,size:t=256,supersample:n=2,radius:r=3.5,which:o=0,light:s="studio",channel:i="lit",background:l=0}){let h=this.choose({light:s,channel:i,turn:0}),u=t*n,d=new Fe(u,u,{type:Cn}),f=this.view.at(1).clone();f.position.set(...e).normalize().multiplyScalar(r),f.up.set(0,1,0),f.lookAt(0,0,0),f.near=.05,f.far=r+4,f.updateProjectionMatrix(),f.updateMatrixWorld(),this.picture(o,d,f,{wireframe:!1,background:[l,l,l]});let x=new Float32Array(4*u*u);this.renderer.readRenderTargetPixels(d,0,0,u,u,x),d.dispose();let v=new Uint8ClampedArray(4*t*t),M=1/(n*n),F=y=>h?y>.0031308?1.055*y**(1/2.4)-.055:12.92*y:y;for(let y=0;y<t;y++)for(let K=0;K<t;K++){let me=[0,0,0,0];for(let C=0;C<n;C++)for(let xe=0;xe<n;xe++){let zt=4*((u-1-(y*n+C))*u+K*n+xe);for(let Y=0;Y<4;Y++)me[Y]+=x[zt+Y]*M}let De=4*(y*t+K);for(let C=0;C<3;C++)v[De+C]=255*F(me[C]+(1-me[3])*l);v[De+3]=255}return v}},Pt={polygonOffsetFactor:1,polygonOffsetUnits:1};function Rn(a,e){for(let t of a)!t||t.isOffset===e||(t.isOffset=e,t.root.traverse(n=>{for(let r of[n.material??[]].flat())Object.assign(r,{polygonOffset:e,...Pt})}))}function Oe(a){return[1,3,5].map(e=>parseInt(a.slice(e,e+2),16)/255)}function kt(a,e){let t=a.filter(f=>f.clips.length),n=[...new Set(t.flatMap(f=>f.clips.map((x,v)=>x.name||`Clip ${v+1}`)))],r=!1,o=0,s=0,i=0,l=()=>{for(let f of t)f.mixer.setTime(Math.min(s,i));c("time").value=i?s/i:0,c("time-value").textContent=`${s.toFixed(1)} s`,e()},h=f=>{i=0,s=0;for(let x of t){x.mixer.stopAllAction();let v=x.clips.find((M,F)=>(M.name||`Clip ${F+1}`)===f);v&&(x.mixer.clipAction(v).play(),i=Math.max(i,v.duration))}l()},u=f=>{r&&(s=i?(s+(f-o)/1e3)%i:0,o=f,l(),requestAnimationFrame(u))},d=f=>{f&&t.length&&!i&&h(c("clip").value),r=f&&t.length>0,c("play").setAttribute("aria-label",r?"Pause":"Play"),c("play-icon").setAttribute("href",r?"#icon-pause":"#icon-play"),o=performance.now(),r&&requestAnimationFrame(u),e()};return c("animation-section").hidden=t.length===0,t.length&&(k(c("clip"),n.map(f=>[f,f])),c("clip").addEventListener("change",f=>h(f.target.value)),c("play").addEventListener("click",()=>d(!r)),c("time").addEventListener("input",f=>{d(!1),i||h(c("clip").value),s=f.target.value*i,l()})),{isPlaying:()=>r,toggle:()=>d(!r)}}function Ft(a,e){document.addEventListener("keydown",o=>{if(o.ctrlKey||o.metaKey||o.altKey||c("help").open)return;let{target:s}=o;if(s===c("canvas")&&e(o))return o.preventDefault();if(s.matches('select, input[type="text"], input[type="number"]')||s.matches("input, button")&&[" ","Enter"].includes(o.key))return;let i=o.key.length===1?o.key.toLowerCase():o.key,l=a.find(([h])=>h.includes(i));l&&(o.preventDefault(),l[2](i))});let t=c("shortcuts"),n=(o,s)=>{let i=document.createElement("dt"),l=document.createElement("dd");for(let h of o){let u=document.createElement("kbd");u.textContent=h===" "?"Space":h.length===1?h.toUpperCase():h,i.append(u)}l.textContent=s,t.append(i,l)};n(["←","→","↑","↓"],"Turn, with the picture in focus"),n(["+","−"],"Zoom, with the picture in focus");for(let[o,s]of a)n(o,s);let r=c("help");c("help-open").addEventListener("click",()=>r.showModal()),c("help-close").addEventListener("click",()=>r.close()),r.addEventListener("click",o=>{o.target===r&&r.close()})}function Ot(a){let e=c("splitter"),t=n=>a.set({split:Math.min(.98,Math.max(.02,n))});e.addEventListener("pointerdown",n=>{e.setPointerCapture(n.pointerId),e.focus({focusVisible:!1}),n.preventDefault()}),e.addEventListener("pointermove",n=>{if(!e.hasPointerCapture(n.pointerId))return;let{left:r,width:o}=e.parentElement.getBoundingClientRect();t((n.clientX-r)/o)}),e.addEventListener("keydown",n=>{let r={ArrowLeft:-.02,ArrowRight:.02,ArrowDown:-.02,ArrowUp:.02,PageDown:-.1,PageUp:.1},{split:o}=a.get();if(n.key in r)t(o+r[n.key]);else if(n.key==="Home"||n.key==="End")t(n.key==="Home"?0:1);else return;n.preventDefault(),n.stopPropagation()}),a.on(["split","mode"],({split:n,mode:r})=>{e.hidden=r!=="split",e.style.left=`${100*n}%`,e.setAttribute("aria-valuenow",String(Math.round(100*n))),e.setAttribute("aria-valuetext",`${Math.round(100*n)} percent model`)})}function Rt(a){let e=matchMedia("(prefers-color-scheme: dark)"),t=!1,n=()=>{t||a.set({theme:e.matches?"dark":"light"})};e.addEventListener("change",n),a.on(["theme"],({theme:r})=>{document.documentElement.dataset.theme=r}),n(),c("theme").addEventListener("click",()=>{t=!0,a.set({theme:a.get().theme==="dark"?"light":"dark"})})}var Nt=250,_n=8e3,$n=["mode","channel","wireframe","parallax","light","turn","exposure","tone","background","split","level","theme","uvLines"],p=ct({mode:"model",channel:"lit",wireframe:!1,parallax:!0,light:"studio",turn:0,exposure:0,tone:"none",background:"page",split:.5,level:"auto",turntable:!1,uvLines:!0,theme:"light",isReady:!1,hasCompare:!1}),_t=a=>getComputedStyle(document.documentElement).getPropertyValue(a).trim(),m,Ne,g=null,b=null,fe=0,W=0,pe=0,It=0,Ie=[];function Dt(){let a=p.get(),e={page:Oe(_t("--viewport")),black:[0,0,0],white:[1,1,1],grey:Oe("#bcbcbc")}[a.background];return{layout:{high:w.second,split:w.split,side:w.side,difference:w.difference}[a.mode]??w.first,uv:a.mode==="uv",channel:a.channel,light:a.light,turn:a.turn*Math.PI/180,wireframe:a.wireframe,ink:_t("--wire"),exposure:2**a.exposure,tone:Z.findIndex(([t])=>t===a.tone),split:a.split,background:e,uvLines:a.uvLines}}function _e(){if(fe=0,!p.get().isReady)return;m.resize();let{level:a}=p.get(),e=Math.min(m.width,m.height),t=m.view.pixels(e),n=a==="auto"?g.forSize(t,m.width,m.height):a;n!==g.shown&&g.show(n),m.draw(Dt()),ut(c("canvas"),t,["model","high","split","difference"].includes(p.get().mode)),Dn(t,e),Un(),clearTimeout(W),W=0,!Ne.isPlaying()&&!p.get().turntable&&(W=setTimeout(Nn,Nt))}async function Nn(){W=0;let a=++pe,e=m.timer.poll();Re();let{mode:t,hasCompare:n}=p.get();if(n&&t!=="uv"){let r=await m.measure(Dt());if(a!==pe)return;c("psnr").textContent=Number.isFinite(r)?`${r.toFixed(2)} dB`:"the same picture",c("reading").hidden=!1,Re()}e&&setTimeout(()=>{m.timer.poll(),Re()},Nt),It=a}async function In(){do await new Promise(a=>setTimeout(a,20));while(fe||W||It!==pe)}function A(){pe++,fe||(fe=requestAnimationFrame(_e))}function Dn(a,e){let[t,n]=[12,e*8];c("size").value=1e3*Math.log(a/t)/Math.log(n/t),c("size-value").textContent=`${T(a)} px`,c("size").setAttribute("aria-valuetext",`${Math.round(a)} pixels`)}function Un(){let{mode:a,hasCompare:e}=p.get(),t=["split","side"].includes(a),[n,r]=[c("label-first"),c("label-second")],o=g.count>1?g.shown===null?", too small to be drawn":`, level ${g.shown}`:"",s=g.shown===null?0:g.figures[g.shown].triangles;n.hidden=!(t||g.count>1)||a==="uv"||a==="high",n.textContent=`${g.model().name}${o} · ${T(s)} triangles`,r.hidden=!e||!(t||a==="high"),e&&(r.textContent=`${b.name} · ${T(b.known.triangles)} triangles`)}function Re(){let a={triangles:0,vertices:0,materials:0,textures:0,texels:0},e={...g.shown===null?a:g.figures[g.shown],bytes:g.model().bytes,drawCalls:m.drawCalls[0]},t=b&&{...b.known,bytes:b.bytes,drawCalls:m.drawCalls[1]},{timer:n,milliseconds:r}=m,o=n.isAvailable?["GPU time",n.milliseconds===null?"–":`${n.milliseconds.toFixed(2)} ms`]:["Frame",r===null?"–":`${r.toFixed(1)} ms`];xt(e,t,o)}function Bn(){let a=[];for(let[e,t]of[["Model",g.model()],["High-poly",b]]){if(!t)continue;let n=t.textures();for(let r of n){let{width:o,height:s}=r.texture.image;a.push({model:t,entry:r,label:`${r.label}, ${o} × ${s} (${[e,r.material].filter(Boolean).join(", ")})`})}n.length||a.push({model:t,entry:null,label:`No texture (${e})`})}Ie=a,k(c("texture"),a.map((e,t)=>[t,e.label])),Ut(0)}function Ut(a){let{model:e,entry:t}=Ie[a];m.uv.show(t,e.meshes()),A()}function Bt(a){c("message").hidden=!0,c("failure").hidden=!1,c("failure-text").textContent=a.message??String(a),document.body.classList.add("failed"),c("panel-toggle").hidden=!0}function zn(a){c("banner-text").textContent=a,c("banner").hidden=!1}function Vn(){let a=c("canvas"),e=()=>Math.min(a.clientWidth,a.clientHeight),t=()=>p.get().mode==="uv";dt(a,{turn(n,r){t()?m.uv.move(n,r,e()):m.view.orbit(-n*.008,r*.008),A()},move(n,r){t()?m.uv.move(n,r,e()):m.view.pan(n/e(),r/e()),A()},zoom(n,r,o){t()?m.uv.zoom(n,(r-a.clientWidth/2)/e(),(o-a.clientHeight/2)/e()):m.view.zoom(n),A()}}),a.addEventListener("dblclick",$e);for(let n of["fit","fit-uv"])c(n).addEventListener("click",$e);c("size").addEventListener("input",n=>{let r=Math.min(m.width,m.height),[o,s]=[12,r*8];m.view.setPixels(o*(s/o)**(n.target.value/1e3),r),A()}),c("texture").addEventListener("change",n=>Ut(Number(n.target.value))),new ResizeObserver(A).observe(a)}function $e(){p.get().mode==="uv"?m.uv.fit():m.view.fit(),A()}function Xn({key:a}){let e=p.get().mode==="uv",t=.12,n={ArrowLeft:[-1,0],ArrowRight:[1,0],ArrowUp:[0,1],ArrowDown:[0,-1]};if(n[a]){let[r,o]=n[a];e?m.uv.move(-40*r,40*o,1e3):m.view.orbit(r*t,o*t)}else if(a==="+"||a==="="||a==="-"){let r=a==="-"?1.15:.8695652173913044;e?m.uv.zoom(r,0,0):m.view.zoom(r)}else return!1;return A(),!0}function $t(a,e){let t=e.indexOf(p.get()[a]);p.set({[a]:e[(t+1)%e.length]})}function Gn(a){let e=r=>{document.body.classList.toggle("panel-closed",!r),c("panel-toggle").setAttribute("aria-expanded",String(r)),A()},t=()=>e(document.body.classList.contains("panel-closed"));c("panel-toggle").addEventListener("click",t),e(!matchMedia("(max-width: 760px)").matches);let n=r=>{if(g.count<2)return;let o=p.get().level==="auto"?g.shown??g.count-1:p.get().level;p.set({level:Math.min(g.count-1,Math.max(0,o+r))})};Ft([[a.map((r,o)=>String(o+1)),"Views, from left to right",r=>p.set({mode:a[Number(r)-1]})],[["c"],"Next channel",()=>$t("channel",D.map(r=>r.key))],[["l"],"Next light",()=>$t("light",U.map(r=>r.key))],[["w"],"Wireframe",()=>p.set({wireframe:!p.get().wireframe})],[["d"],"Parallax maps",()=>{c("parallax-switch").hidden||p.set({parallax:!p.get().parallax})}],[["r"],"Turntable",()=>p.set({turntable:!p.get().turntable})],[["f"],"Fit to view",$e],[["[","]"],"Finer or coarser level of detail",r=>n(r==="["?-1:1)],[[" "],"Play or pause the animation",()=>Ne.toggle()],[["t"],"Light or dark",()=>c("theme").click()],[["p"],"Settings",t],[["?"],"This help",()=>c("help").showModal()]],Xn)}function Hn(){let a=0,e=t=>{p.get().turntable&&(m.view.orbit(Math.min(.1,(t-a)/1e3)*.6,0),a=t,A(),requestAnimationFrame(e))};p.on(["turntable"],({turntable:t})=>{a=performance.now(),t&&requestAnimationFrame(e)})}function qn(){let a=c("levels");a.hidden=g.count<2;let e=g.figures.map((t,n)=>[n,`${n}: ${T(t.triangles)}`]);j(a,"level",[["auto","By size"],...e],t=>p.set({level:t})),p.on(["level"],({level:t})=>V(a,t))}async function jn(){let a=await fetch("session.json").then(n=>n.json()).catch(()=>{throw new Error("parbake view no longer answers: it was ended. Start it again.")}),e=a.models.filter(n=>n.role==="level"),t=a.models.find(n=>n.role==="compare");return c("version").textContent=`Parbake ${a.version}.`,c("title").textContent=e[0].name,c("subtitle").textContent=t?`compared with ${t.name}`:"",document.title=`${e[0].name} – Parbake`,c("message-text").textContent=`Reading ${e.map(n=>n.name).join(", ")}`,{files:e,other:t}}async function Wn({files:a,other:e}){let t=a.map(Pe),n=e&&Pe(e);for(let h of[...t,n])h?.catch(()=>{});try{m=new de(c("canvas"))}catch{throw new Error("This browser has no WebGL 2, or it is switched off. Turn on hardware acceleration, or use another browser.")}let r=lt(m.renderer),o=n?n.then(r).catch(h=>h):null,s=await Promise.all(t.map(h=>h.then(r))),i=await o,l=i instanceof Error?i.message:null;return b=l?null:i,g=new ie(s),b&&(b.known=b.figures()),m.setModels(g,b),{models:[...s,b].filter(Boolean),problem:l}}function Kn(a){Ne=kt(a,A);let e=ft.filter(([t])=>b||!pt(t));j(c("modes"),"mode",e,t=>p.set({mode:t})),c("modes").disabled=!1,Ot(p),qn(),Vn(),Hn(),Gn(e.map(([t])=>t)),c("parallax-switch").hidden=!a.some(t=>t.parallax.length),p.on(["parallax"],({parallax:t})=>{for(let n of a)n.setParallax(t)}),p.set({isReady:!0,hasCompare:b!==null,mode:b?"split":"model"}),p.on(["mode","hasCompare"],({mode:t,hasCompare:n})=>{c("legend").hidden=t!=="difference",(!n||t==="uv")&&(c("reading").hidden=!0),t==="uv"&&!Ie.length&&Bn(),V(c("modes"),t)}),p.on($n,A)}async function Yn(){mt(p),Rt(p),c("legend-ramp").style.background=`linear-gradient(90deg, ${O.join(", ")})`,c("legend-most").textContent=`${Math.round(ge*255)} of 255 and more`,c("banner-close").addEventListener("click",()=>{c("banner").hidden=!0}),c("canvas").addEventListener("webglcontextlost",()=>{Bt(new Error("The graphics processor has dropped this page, most likely for want of memory. Reload the page."))});let a=setTimeout(()=>{c("message-text").textContent+=". Large models take a while."},_n),{models:e,problem:t}=await Wn(await jn());clearTimeout(a),Kn(e);let n=()=>gt([...new Set([...e.flatMap(r=>r.notes),...t?[t]:[]])]);t&&zn(`The model is shown by itself: ${t}`),n(),_e(),c("message").hidden=!0,e.some(r=>r.hasExtensions)&&requestAnimationFrame(()=>setTimeout(()=>p.set({light:"room"}))),setTimeout(n,1e3),window.parbake={store:p,stage:m,redraw:A,settled:In,snapshot:()=>(_e(),c("canvas").toDataURL())}}Yn().catch(Bt);
