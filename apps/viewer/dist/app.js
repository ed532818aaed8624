import{LinearSRGBColorSpace as xa,Mesh as va,OrthographicCamera as wa,PlaneGeometry as ba,Scene as Sa,ShaderMaterial as ya}from"./three.js";var b={first:0,second:1,split:2,side:3,difference:4},ne=[["none","None"],["neutral","Khronos neutral"],["aces","ACES"]],O=["#0d0f1c","#45217a","#b5366e","#f07f3c","#fcf2a4"],Re=.25,q=t=>`vec3(${[1,3,5].map(e=>(parseInt(t.slice(e,e+2),16)/255).toFixed(4))})`,Ma="varying vec2 at; void main() { at = uv; gl_Position = vec4(position.xy, 0.0, 1.0); }",Aa=`
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
  vec3 c = mix(${q(O[0])}, ${q(O[1])}, clamp(4.0 * x, 0.0, 1.0));
  c = mix(c, ${q(O[2])}, clamp(4.0 * x - 1.0, 0.0, 1.0));
  c = mix(c, ${q(O[3])}, clamp(4.0 * x - 2.0, 0.0, 1.0));
  return mix(c, ${q(O[4])}, clamp(4.0 * x - 3.0, 0.0, 1.0));
}
void main() {
#if LAYOUT == ${b.first}
  vec3 c = shown(texture2D(first, at));
#elif LAYOUT == ${b.second}
  vec3 c = shown(texture2D(second, at));
#elif LAYOUT == ${b.split}
  vec3 c = shown(at.x < split ? texture2D(first, at) : texture2D(second, at));
#elif LAYOUT == ${b.side}
  vec2 half_ = vec2(fract(2.0 * at.x), at.y);
  vec3 c = shown(at.x < 0.5 ? texture2D(first, half_) : texture2D(second, half_));
#else
  vec3 d = shown(texture2D(first, at)) - shown(texture2D(second, at));
  vec3 c = heat(sqrt(dot(d, d) / 3.0) / ${Re.toFixed(4)});
#endif
  gl_FragColor = vec4(c, 1.0);
}`,Ca=t=>t>.04045?((t+.055)/1.055)**2.4:t/12.92,ae=class{constructor(e){e.outputColorSpace=xa,this.renderer=e,this.uniforms={first:{value:null},second:{value:null},split:{value:.5},exposure:{value:1},background:{value:[0,0,0]},backgroundLight:{value:[0,0,0]}},this.materials={},this.scene=new Sa,this.quad=new va(new ba(2,2)),this.quad.frustumCulled=!1,this.scene.add(this.quad),this.camera=new wa}material(e,a,n){let o=`${e} ${a} ${n}`;return this.materials[o]??=new ya({defines:{LAYOUT:e,TONE:n,...a?{IS_COLOR:1}:{}},uniforms:this.uniforms,vertexShader:Ma,fragmentShader:Aa,depthTest:!1,depthWrite:!1}),this.materials[o]}draw({layout:e,isColor:a,tone:n=0,...o},r=null){for(let[s,l]of Object.entries(o))this.uniforms[s].value=l;this.uniforms.backgroundLight.value=this.uniforms.background.value.map(Ca),this.quad.material=this.material(e,a,n),this.renderer.setRenderTarget(r),this.renderer.render(this.scene,this.camera)}};import{Matrix3 as _a}from"./three.js";import{DataTexture as Ta,FloatType as Ea,NearestFilter as La,RGFormat as Pa,Vector3 as _}from"./three.js";var A=32,B=512,I=(t,e,a)=>new _(t,e,a).normalize(),R=[[I(0,1,0),2,new _(.42,.44,.48)],[I(0,-1,0),2.5,new _(.14,.12,.1)],[I(.6,.7,.5),24,new _(4.6,4.4,4.1)],[I(-.9,.25,.35),16,new _(1.2,1.35,1.6)],[I(-.3,.45,-.85),30,new _(3.4,3.4,3.6)],[I(.95,.05,-.3),60,new _(4.2,3.8,3.2)]];function Ra(t){let e=0;for(let a=0;a<32;a++)e=e*2+(t>>>a&1)>>>0;return e/4294967296}function ka(t,e){let a=Math.max(t,.001),n=Math.max(e,.02)**2,o=n*n,r=Math.sqrt(Math.max(0,1-a*a)),s=0,l=0;for(let i=0;i<B;i++){let h=Oa[i],u=Math.sqrt((1-h)/(1+(o-1)*h)),f=r*Math.sqrt(Math.max(0,1-u*u))*Fa[i]+a*u,p=2*f*u-a;if(p<=0||f<=0)continue;let m=(H,M)=>H*Math.sqrt(M*M*(1-o)+o),x=.5/(m(p,a)+m(a,p))*p*4*f/u,w=(1-f)**5;s+=(1-w)*x,l+=w*x}return[s/B,l/B]}var Oa=Float64Array.from({length:B},(t,e)=>Ra(e)),Fa=Float64Array.from({length:B},(t,e)=>Math.cos(2*Math.PI*(e+.5)/B)),F=null;function Je(){if(F)return F;let t=new Float32Array(2*A*A);for(let e=0;e<A*A;e++)t.set(ka(e%A/(A-1),Math.floor(e/A)/(A-1)),2*e);return F=new Ta(t,A,A,Pa,Ea),F.magFilter=F.minFilter=La,F.needsUpdate=!0,F}var Ze={pbAxis:{value:R.map(t=>t[0])},pbSharpness:{value:R.map(t=>t[1])},pbLamp:{value:R.map(t=>t[2])}},et=`
uniform vec3 pbAxis[${R.length}];
uniform float pbSharpness[${R.length}];
uniform vec3 pbLamp[${R.length}];
uniform highp sampler2D pbSplitSum;
uniform mat3 pbTurn;
uniform float pbUnit;
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
  vec2 place = clamp(vec2(cosine, roughness), 0.0, 1.0) * ${A-1}.0;
  ivec2 node = min(ivec2(place), ivec2(${A-2}));
  vec2 at = place - vec2(node);
  vec2 a = mix(texelFetch(pbSplitSum, node, 0).rg, texelFetch(pbSplitSum, node + ivec2(1, 0), 0).rg, at.x);
  vec2 b = mix(texelFetch(pbSplitSum, node + ivec2(0, 1), 0).rg, texelFetch(pbSplitSum, node + ivec2(1, 1), 0).rg, at.x);
  return mix(a, b, at.y);
}
vec3 pbShare(vec3 f0, float f90, float roughness, float grazing, vec2 table) {
  float lost = 1.0 - table.x - table.y;
  vec3 most = max(vec3((1.0 - roughness) * f90), f0);
  vec3 once = (f0 + (most - f0) * grazing) * table.x + table.y * f90;
  vec3 mean = f0 + (1.0 - f0) / 21.0;
  return once + lost * once * mean / (1.0 - mean * lost);
}
float pbFifth(float x) { float square = x * x; return square * square * x; }
vec3 pbIrradiance(vec3 normal) {
  vec3 light = PB_AMBIENT;
  for (int i = 0; i < ${R.length}; i++) light += pbLamp[i] * pbDiffuse(pbSharpness[i], dot(pbTurn * pbAxis[i], normal));
  return light;
}
vec3 pbReflected(vec3 mirrored, float alpha) {
  vec3 light = PB_AMBIENT;
  float lobe = 0.5 / (alpha * alpha);
  for (int i = 0; i < ${R.length}; i++)
    light += pbLamp[i] * pbSmoothed(pbSharpness[i], dot(pbTurn * pbAxis[i], mirrored), lobe);
  return light;
}
// The cosine to the lamp far away, and D V of GGX; 0 where the surface is turned away. schlick is Schlick's fifth power.
vec2 pbSun(vec3 normal, vec3 viewer, float cosine, float alpha, out float schlick) {
  vec3 sun = pbTurn * PB_SUN_FROM, sum = sun + viewer;
  float nl = dot(normal, sun);
  schlick = 0.0;
  if (nl <= 0.0 || dot(sum, sum) < 1e-8) return vec2(0.0);
  vec3 h = normalize(sum), across = cross(normal, h);
  float nh = dot(normal, h), width = alpha * alpha;
  float spread = dot(across, across) + width * nh * nh;
  float masks = nl * sqrt(cosine * cosine * (1.0 - width) + width) + cosine * sqrt(nl * nl * (1.0 - width) + width);
  schlick = pbFifth(max(1.0 - dot(viewer, h), 0.0));
  return vec2(nl, width / (3.14159265 * spread * spread) * 0.5 / masks);
}
// Without layers; the share that a dielectric reflects is left in reflects, and scatters is the rest that does not pass.
vec3 pbBase(vec3 color, float metallic, float rough, float occlusion, vec3 emission, vec3 normal, vec3 viewer,
    vec3 f0, float f90, float scatters, out vec3 reflects) {
  float roughness = clamp(rough, 0.0525, 1.0), alpha = roughness * roughness;
  float towards = dot(normal, viewer), cosine = clamp(towards, 1e-4, 1.0);
  vec3 reflected = pbReflected(2.0 * towards * normal - viewer, alpha);
  vec2 table = pbScaleAndBias(cosine, roughness);
  float grazing = pbFifth(1.0 - cosine), schlick;
  reflects = pbShare(f0, f90, roughness, grazing, table);
  vec3 dielectric = mix(pbIrradiance(normal) * color * scatters, reflected, reflects);
  vec3 metal = reflected * pbShare(color, 1.0, roughness, grazing, table);
  vec3 light = mix(dielectric, metal, metallic) * occlusion + emission;
  vec2 sun = pbSun(normal, viewer, cosine, alpha, schlick);
  vec3 below = mix(color * scatters / 3.14159265, vec3(sun.y), f0 + (f90 - f0) * schlick);
  return light + mix(below, sun.y * (color + (1.0 - color) * schlick), metallic) * PB_SUN * sun.x;
}
// What a sheen adds, and in the fourth number what multiplies all that is below it.
vec4 pbSheen(vec3 color, float rough, float occlusion, vec3 normal, vec3 viewer) {
  float r = clamp(rough, 0.07, 1.0), rr = r * r, cosine = clamp(dot(normal, viewer), 1e-4, 1.0);
  float inverse = 1.0 / (r + 0.1);
  float slope = -1.9362 + 1.0678 * r + 0.4573 * rr - 0.8469 * inverse;
  float start = -0.6014 + 0.5538 * r - 0.4670 * rr - 0.1255 * inverse;
  float albedo = min(exp(slope * cosine + start), 1.0);
  vec3 light = pbIrradiance(normal) * albedo * occlusion, sun = pbTurn * PB_SUN_FROM, sum = sun + viewer;
  float nl = dot(normal, sun);
  if (nl > 0.0 && dot(sum, sum) >= 1e-8) {
    float sine = min(length(cross(normal, normalize(sum))), 1.0);
    float distribution = (2.0 + 1.0 / rr) * pow(sine, 1.0 / rr) / 6.28318531;
    light += PB_SUN * (distribution / (4.0 * (nl + cosine - nl * cosine)) * nl);
  }
  return vec4(light * color, 1.0 - max(color.r, max(color.g, color.b)) * albedo);
}
// The same of a coat.
vec4 pbCoat(float strength, float rough, float occlusion, vec3 normal, vec3 viewer) {
  float roughness = clamp(rough, 0.0525, 1.0), alpha = roughness * roughness;
  float towards = dot(normal, viewer), cosine = clamp(towards, 1e-4, 1.0), schlick;
  vec2 table = pbScaleAndBias(cosine, roughness), sun = pbSun(normal, viewer, cosine, alpha, schlick);
  vec3 light = pbReflected(2.0 * towards * normal - viewer, alpha) * (0.04 * table.x + table.y) * occlusion;
  light += PB_SUN * (sun.x * sun.y * (0.04 + 0.96 * schlick));
  return vec4(light * strength, 1.0 - strength * (0.04 + 0.96 * pbFifth(1.0 - cosine)));
}
`;var D=[{key:"lit",label:"Lit",code:0,isColor:!0},{key:"base",label:"Base colour",code:1,isColor:!0},{key:"normal",label:"Normal",code:2},{key:"roughness",label:"Roughness",code:3},{key:"metallic",label:"Metallic",code:4},{key:"occlusion",label:"Occlusion",code:5},{key:"emission",label:"Emission",code:6,isColor:!0},{key:"opacity",label:"Opacity",code:7},{key:"checker",label:"UV checker",code:8}],C={three:0,studio:10,headlight:11},re={pbTurn:{value:new _a},pbUnit:{value:1},pbSplitSum:{value:null},...Ze},oe=new Map,E=0;function tt(t){if(t===C.studio&&(re.pbSplitSum.value=Je()),t!==E){E=t;for(let[e,a]of oe)a>0&&at(e,a),e.needsUpdate=!0}}function at(t,e){t.transmission=ke(E)?e:0}var ke=t=>t===C.three||t===C.studio;function nt(t){re.pbUnit.value=t}function ot(t){let[e,a]=[Math.cos(t),Math.sin(t)];re.pbTurn.value.set(e,0,a,0,1,0,-a,0,e)}var Na=`
varying vec2 pbUv;
vec3 pbChecker(vec2 uv) {
  vec2 at = floor(uv * 16.0), tile = fract(at / 16.0);
  vec3 hue = vec3(0.30 + 0.55 * tile.x, 0.38 + 0.4 * tile.y, 0.85 - 0.45 * tile.x);
  return mix(hue, hue * 0.55, mod(at.x + at.y, 2.0));
}
`,$a={1:["diffuseColor.rgb","diffuseColor.rgb"],2:["pbNormal * 0.5 + 0.5","vec3(0.5, 0.5, 1.0)"],3:["vec3(roughnessFactor)","vec3(1.0)"],4:["vec3(metalnessFactor)","vec3(0.0)"],5:["vec3(pbOcclusion)","vec3(1.0)"],6:["totalEmissiveRadiance","vec3(0.0)"],7:["vec3(diffuseColor.a)","vec3(diffuseColor.a)"],8:["pbChecker(pbUv)","pbChecker(pbUv)"],10:["pbLit","diffuseColor.rgb"],11:["max(dot(pbNormal, pbViewer), 0.0) * diffuseColor.rgb + totalEmissiveRadiance","diffuseColor.rgb"]},Ua=`
  vec3 pbF0 = vec3(0.04), pbReflects;
  float pbF90 = 1.0, pbPassing = 0.0;
  #ifdef USE_TRANSMISSION
    float pbThickness = thickness;
    pbPassing = transmission;
    #ifdef USE_TRANSMISSIONMAP
      pbPassing *= texture2D(transmissionMap, vTransmissionMapUv).r;
    #endif
    #ifdef USE_THICKNESSMAP
      pbThickness *= texture2D(thicknessMap, vThicknessMapUv).g;
    #endif
  #endif
  #ifdef USE_SPECULAR
    vec3 pbTint = specularColor;
    pbF90 = specularIntensity;
    #ifdef USE_SPECULAR_COLORMAP
      pbTint *= texture2D(specularColorMap, vSpecularColorMapUv).rgb;
    #endif
    #ifdef USE_SPECULAR_INTENSITYMAP
      pbF90 *= texture2D(specularIntensityMap, vSpecularIntensityMapUv).a;
    #endif
    float pbIor = (ior - 1.0) / (ior + 1.0);
    pbF0 = min(pbIor * pbIor * pbTint, vec3(1.0)) * pbF90;
  #endif
  vec3 pbLit = pbBase(diffuseColor.rgb, metalnessFactor, roughnessFactor, pbOcclusion, totalEmissiveRadiance, pbNormal, pbViewer,
    pbF0, pbF90, 1.0 - pbPassing, pbReflects);
  float pbBelow = 1.0;
  #ifdef USE_SHEEN
    vec3 pbSheenColor = sheenColor;
    float pbSheenRoughness = sheenRoughness;
    #ifdef USE_SHEEN_COLORMAP
      pbSheenColor *= texture2D(sheenColorMap, vSheenColorMapUv).rgb;
    #endif
    #ifdef USE_SHEEN_ROUGHNESSMAP
      pbSheenRoughness *= texture2D(sheenRoughnessMap, vSheenRoughnessMapUv).a;
    #endif
    vec4 pbCloth = pbSheen(pbSheenColor, pbSheenRoughness, pbOcclusion, pbNormal, pbViewer);
    pbLit = pbLit * pbCloth.a + pbCloth.rgb;
    pbBelow *= pbCloth.a;
  #endif
  #ifdef USE_CLEARCOAT
    float pbStrength = clearcoat, pbCoatRoughness = clearcoatRoughness;
    #ifdef USE_CLEARCOATMAP
      pbStrength *= texture2D(clearcoatMap, vClearcoatMapUv).x;
    #endif
    #ifdef USE_CLEARCOAT_ROUGHNESSMAP
      pbCoatRoughness *= texture2D(clearcoatRoughnessMap, vClearcoatRoughnessMapUv).y;
    #endif
    vec4 pbVarnish = pbCoat(pbStrength, pbCoatRoughness, pbOcclusion,
      inverseTransformDirection(clearcoatNormal, viewMatrix), pbViewer);
    pbLit = pbLit * pbVarnish.a + pbVarnish.rgb;
    pbBelow *= pbVarnish.a;
  #endif
  #ifdef USE_TRANSMISSION
    vec3 pbWay = getVolumeTransmissionRay(pbNormal, pbViewer, pbThickness, ior, modelMatrix);
    vec3 pbLeft = pbThickness > 0.0 ? volumeAttenuation(length(pbWay) / pbUnit, attenuationColor, attenuationDistance) : vec3(1.0);
    vec3 pbPasses = clamp(pbPassing * pbLeft * (1.0 - metalnessFactor) * (1.0 - pbReflects) * diffuseColor.rgb, 0.0, 1.0) * pbBelow;
    vec4 pbOnScreen = projectionMatrix * viewMatrix * vec4(vWorldPosition + pbWay, 1.0);
    vec4 pbBehind = getTransmissionSample(0.5 * pbOnScreen.xy / pbOnScreen.w + 0.5, max(roughnessFactor, 0.0525), ior);
    pbLit += pbPasses * pbBehind.rgb;
    diffuseColor.a *= 1.0 - dot(pbPasses, vec3(1.0 / 3.0)) * (1.0 - pbBehind.a);
  #endif
`,Ia=(t,e)=>`
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
  ${e&&t===C.studio?Ua:""}
  gl_FragColor = vec4(${$a[t][e?0:1]}, ${t===7||t===8?"1.0":"diffuseColor.a"});
  return;
}
`;function Ba(t){if(Object.assign(t.uniforms,re),E===C.three)return;let e=["#include <lights_physical_fragment>","#include <opaque_fragment>"].find(r=>t.fragmentShader.includes(r)),a=e!=="#include <opaque_fragment>",n=a&&E===C.studio?et:"",o=(E===8?Na:"")+n;E===8&&(t.vertexShader=t.vertexShader.replace("void main() {",`varying vec2 pbUv;
void main() {
  pbUv = uv;`)),t.fragmentShader=t.fragmentShader.replace("void main() {",`${o}
void main() {`).replace(e,`${Ia(E,a)}
${e}`)}function rt(t){if(oe.has(t)||!t.isMeshStandardMaterial&&!t.isMeshBasicMaterial)return;let{transmission:e=0}=t;oe.set(t,e),e>0&&at(t,e);let{onBeforeCompile:a,customProgramCacheKey:n}=t;t.onBeforeCompile=function(o,r){Ba(o),a.call(this,o,r)},t.customProgramCacheKey=function(){return`parbake ${E} ${n.call(this)}`}}function st(t){oe.delete(t)}var se=[["map","Base colour"],["normalMap","Normal"],["roughnessMap","Roughness, metallic"],["metalnessMap","Roughness, metallic"],["aoMap","Occlusion"],["emissiveMap","Emission"],["clearcoatMap","Clearcoat"],["clearcoatRoughnessMap","Clearcoat roughness"],["clearcoatNormalMap","Clearcoat normal"],["sheenColorMap","Sheen"],["sheenRoughnessMap","Sheen roughness"],["transmissionMap","Transmission"],["thicknessMap","Thickness"],["specularColorMap","Specular colour"],["specularIntensityMap","Specular"],["iridescenceMap","Iridescence"],["iridescenceThicknessMap","Iridescence thickness"],["anisotropyMap","Anisotropy"]];import{BackSide as Da,BufferAttribute as Ga,Color as za,DirectionalLight as Va,Mesh as Xa,MeshBasicMaterial as Ha,PMREMGenerator as qa,RoomEnvironment as Wa,Scene as ja,SphereGeometry as Ka}from"./three.js";var G=[{key:"studio",label:"Studio, as in eval",shaded:C.studio},{key:"room",label:"Room",shaded:C.three},{key:"sky",label:"Evening sky",shaded:C.three},{key:"sun",label:"Sun",shaded:C.three},{key:"headlight",label:"Headlight, matte",shaded:C.headlight}];function Ya(t){let e=new Ka(10,64,32),{position:a}=e.attributes,n=[],o=new za;for(let s=0;s<a.count;s++)t(o,a.getX(s)/10,a.getY(s)/10,a.getZ(s)/10),n.push(o.r,o.g,o.b);e.setAttribute("color",new Ga(new Float32Array(n),3));let r=new ja;return r.add(new Xa(e,new Ha({vertexColors:!0,side:Da}))),r}function Qa(t,e,a){let n=Math.min(1,Math.exp(-(((a-.12)/.12)**2))*(e>0?1:.2)),[o,r,s]=a>0?[.25,.42,.85]:[.12,.1,.08];t.setRGB(o+(5-o)*n,r+(3-r)*n,s+(1.6-s)*n)}function Ja(t,e,a){let n=Math.max(0,a);t.setRGB(.16+.1*n,.18+.14*n,.2+.24*n)}var ie=class{constructor(e,a){this.renderer=e,this.scenes=a,this.made={},this.suns=a.map(n=>{let o=new Va(16777215,2.6);return o.visible=!1,n.add(o,o.target),o})}environment(e){if(this.made[e])return this.made[e];let a=new qa(this.renderer),n=e==="room"?new Wa:Ya(e==="sky"?Qa:Ja);return this.made[e]=a.fromScene(n,e==="room"?.04:.02).texture,a.dispose(),this.made[e]}choose(e,a){let o=e==="studio"||e==="headlight"?null:this.environment(e);this.scenes.forEach((r,s)=>{r.environment=o,r.environmentRotation.y=a;let l=this.suns[s];l.visible=e==="sun",l.position.set(Math.cos(-a)*3+Math.sin(a)*1.5,3,Math.sin(-a)*3+Math.cos(a)*1.5)})}};import{AnimationMixer as An,Box3 as Cn,DRACOLoader as Tn,GLTFLoader as En,Group as Ln,LoadingManager as Pn,MeshoptDecoder as Rn}from"./three.js";function Za(t){let e=new DataView(t),a=e.getUint32(12,!0);return JSON.parse(new TextDecoder().decode(new Uint8Array(t,20,a)))}function it(t){let{nodes:e=[],accessors:a=[]}=Za(t);a.forEach((r,s)=>{if(r.bufferView===void 0&&r.count>1e7)throw new Error(`accessor ${s} declares ${r.count} elements without any bytes`)});let n=new Uint8Array(e.length),o=r=>[...e[r].children??[],...e[r].extensions?.MSFT_lod?.ids??[]];for(let r=0;r<e.length;r++){let s=n[r]?[]:[[r,o(r)]];for(;s.length;){let[l,i]=s.at(-1);n[l]=1;let h=i.pop();if(h===void 0)n[l]=2,s.pop();else if(h in e){if(n[h]===1)throw new Error(`node ${h} lies below itself`);n[h]||s.push([h,o(h)])}else throw new Error(`node ${l} names node ${h}, and there are ${e.length}`)}}}import{KTX2Loader as en}from"./three.js";var le=class extends en{constructor(e,a){super(e),this.broken=a}init(){return this.transcoderPending??=fetch("basis/basis_transcoder.wasm").then(e=>e.arrayBuffer()).then(e=>{this.workerPool.setWorkerCreator(()=>{let a=new Worker("basis/worker.js"),n=e.slice(0);return a.addEventListener("error",o=>this.broken(new Error(`KTX2: ${o.message}`))),a.postMessage({type:"init",config:this.workerConfig,transcoderBinary:n},[n]),a})}),this.transcoderPending}};import{MeshDepthMaterial as sn,MeshDistanceMaterial as ln,ShaderChunk as Fe}from"./three.js";var V="PARBAKE_materials_parallax";var L="_parallax_offset",z={shift:2,cutout:3},lt=(t,e)=>Array.isArray(t)&&t.length===e&&t.every(Number.isFinite),Oe=t=>Number.isInteger(t?.index)&&t.index>=0;function tn(t){if(t.version!==2)return`its version is ${t.version}, and this reads version 2`;let{cutout:e,limit:a,fadeFootprint:n}=t,o=e===void 0?[[t,z.shift]]:[[t,z.shift],[e,z.cutout]];for(let[r,s]of o){if(!Oe(r?.texture))return"a texture of it is missing";if(!lt(r.scale,4*s)||!lt(r.offset,4*s))return`it has not ${4*s} scales and offsets`}return a!==void 0&&!(a>0&&a<=1)?`its limit is ${a}`:n!==void 0&&!(n>0)?`its fade begins at ${n}`:null}function ct(t,e){let a=t.extensions?.[V];if(!a)return null;let n=tn(a);if(n)return e(`the parallax map of material "${t.name??""}" was left out: ${n}`),null;let{texture:o,scale:r,offset:s,limit:l=.25,fadeFootprint:i=1/0,cutout:h=null}=a;return{texture:o,scale:r,offset:s,limit:l,fadeFootprint:i,cutout:h}}function ht(t){let{baseColorTexture:e,normalTexture:a}=t.extensions[V],n={...t};return Oe(e)&&(n.pbrMetallicRoughness={...t.pbrMetallicRoughness,baseColorTexture:e}),Oe(a)&&(n.normalTexture={...a,scale:t.normalTexture?.scale??1}),n}var an=`
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
`,ut=`
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
${an}
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
`,ft=`
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
`,pt=`
#ifdef PARALLAX_OFFSET
  transformed += _parallax_offset;
#endif
`,ce=`
#ifdef PARALLAX_TANGENT
  vParallaxSide = tangent.w * sign( determinant( mat3( modelViewMatrix ) ) );
  #ifdef USE_INSTANCING
    vParallaxSide *= sign( determinant( mat3( instanceMatrix ) ) );
  #endif
  #ifdef USE_BATCHING
    vParallaxSide *= sign( determinant( mat3( batchingMatrix ) ) );
  #endif
#endif
`;import{ShaderChunk as nn}from"./three.js";var on=/texture2D\(\s*((?!lightMap\b)\w*[mM]ap),\s*(v\w+Uv)\b/g,dt=t=>t.replace(on,"parallaxTexture( $1, $2");function rn(t){return dt(t).replace(/#include <(\w+)>/g,(e,a)=>{let n=nn[a]??"",o=dt(n);return o===n?e:o})}var X=t=>t.map(e=>`#define ${e}
`).join("");function W(t){return t.replace("void main() {",`#ifdef PARALLAX_OFFSET
attribute vec3 ${L};
#endif
void main() {`).replace("#include <begin_vertex>",`#include <begin_vertex>
${pt}`)}function he(t,e,a){let n=t.replace("#include <common>",`#include <common>
${ut}`).replace("#include <map_fragment>",`${ft}
#include <map_fragment>`);return e+(a?rn(n):n)}var cn=["beginnormal_vertex","morphnormal_vertex","skinnormal_vertex","defaultnormal_vertex","normal_vertex"].map(t=>Fe[t].replaceAll("normalMatrix","transpose( inverse( mat3( modelViewMatrix ) ) )")).join(`
`),hn=/#ifdef USE_DISPLACEMENTMAP\s+(?:#include <\w+>\s+)+#endif/,mt=t=>!(t.alphaTest>0)&&!t.alphaHash;function un(t,e,{hasTangents:a,hasNormals:n,hasOffsets:o}){let{maps:r}=e.parallax,s=e.map??e.normalMap,l=!mt(e),i=n&&a,h=["PARALLAX_CUTOUT",l&&"PARALLAX_SHIFT",r.isFading&&"PARALLAX_FADE",!n&&"PARALLAX_FLAT",i&&"PARALLAX_TANGENT",i&&"USE_TANGENT",o&&"PARALLAX_OFFSET"].filter(Boolean),u=`uv${s.channel||""}`,f=X(h)+(e.map?`#define PARALLAX_UV vMapUv
`:`#define PARALLAX_UV vParallaxUv
`)+`#define PARALLAX_IS_ORTHOGRAPHIC ( vParallaxIsPerspective < 0.5 )
`,p=`varying vec3 vViewPosition;
varying float vParallaxIsPerspective;
${e.map?"":`varying vec2 vParallaxUv;
`}`,m=n?cn:"";t.vertexShader=f+W(t.vertexShader).replace("#include <common>",`#include <common>
      ${p}
      ${n?Fe.normal_pars_vertex:""}
      ${i?`attribute vec4 tangent;
varying float vParallaxSide;`:""}
      ${e.map?"":`uniform mat3 parallaxTransform;
${s.channel?`attribute vec2 ${u};`:""}`}`).replace(hn,`${m}
${ce}`).replace("#include <project_vertex>",`#include <project_vertex>
      vViewPosition = - mvPosition.xyz;
      vParallaxIsPerspective = isPerspectiveMatrix( projectionMatrix ) ? 1.0 : 0.0;
      ${e.map?"":`vParallaxUv = ( parallaxTransform * vec3( ${u}, 1 ) ).xy;`}`);let x=he(t.fragmentShader,f,l).replace("#include <common>",`#include <common>
      ${p}
      ${n?Fe.normal_pars_fragment:""}`);l||(x=x.replace("#include <map_fragment>","").replace("#include <alphatest_fragment>","")),t.fragmentShader=x}function fn(t,e,{isDistance:a=!1}={}){let n=a?new ln:new sn,{attributes:o}=e,r={hasTangents:!!o.tangent,hasNormals:!!o.normal,hasOffsets:!!o[L]};return Object.assign(n,{map:t.map,alphaMap:t.alphaMap,alphaTest:t.alphaTest,side:t.side}),n.onBeforeCompile=s=>{let{parallax:l,map:i,normalMap:h}=t;Object.assign(s.uniforms,l.maps.uniforms,{parallaxTransform:{value:(i??h)?.matrix}}),l.isActive&&un(s,t,r)},n.customProgramCacheKey=()=>{let{parallax:s}=t,l=t.map??t.normalMap;return s.isActive?`parallax depth ${[r.hasTangents,r.hasNormals,r.hasOffsets,s.maps.isFading,mt(t),!!t.map].map(Number).join("")} ${l.channel}`:""},t.parallax.followers.add(n),n}function gt(t){let e=new Map;t.traverse(a=>{let{material:n,geometry:o}=a;if(!a.isMesh||!n?.parallax?.maps.hasCutout||a.customDepthMaterial)return;let r=[n.uuid,...["tangent","normal",L].map(s=>o.attributes[s]!==void 0)].join(" ");e.has(r)||e.set(r,[!1,!0].map(s=>fn(n,o,{isDistance:s}))),[a.customDepthMaterial,a.customDistanceMaterial]=e.get(r)})}import{ClampToEdgeWrapping as wt,LinearFilter as bt,NoColorSpace as vn,SRGBColorSpace as wn,Vector3 as bn}from"./three.js";import{CustomBlending as pn,MaxEquation as dn,OneFactor as _e,Vector2 as mn,Vector4 as gn,ZeroFactor as xn}from"./three.js";var ue=t=>Array.from({length:t.length/4},(e,a)=>new gn(...t.slice(4*a,4*a+4)));function xt(t,e){let{height:a}=t.image;if(a%e)throw new Error(`an image of ${a} rows has no ${e} layers of one height`);return new mn(a/e,a)}var fe=class{constructor({texture:e,scale:a,offset:n,limit:o=.25,fadeFootprint:r=1/0,cutout:s=null}){this.textures=s?[e,s.texture]:[e],this.hasCutout=!!s,this.isFading=Number.isFinite(r),this.uniforms={parallaxMap:{value:e},parallaxScale:{value:ue(a)},parallaxOffset:{value:ue(n)},parallaxRows:{value:xt(e,z.shift)},parallaxLimit:{value:o},parallaxFootprint:{value:r},parallaxIsMultisampled:{value:!1}},s&&Object.assign(this.uniforms,{parallaxCutoutMap:{value:s.texture},parallaxCutoutScale:{value:ue(s.scale)},parallaxCutoutOffset:{value:ue(s.offset)},parallaxCutoutRows:{value:xt(s.texture,z.cutout)}})}},vt={blending:pn,blendSrc:_e,blendDst:xn,blendSrcAlpha:_e,blendDstAlpha:_e,blendEquationAlpha:dn};var St=t=>console.warn(`${V}: ${t}`);function yt(t){let e=t.clone();return Object.assign(e,{colorSpace:vn,premultiplyAlpha:!1,generateMipmaps:!1,anisotropy:1,channel:0,minFilter:bt,magFilter:bt,wrapS:wt,wrapT:wt})}function Sn(t){let e=new bn,a=new Map;t.traverse(n=>{let{geometry:o}=n,r=o?.attributes[L];if(!r)return;if(!a.has(o)){let l=0;for(let i=0;i<r.count;i++)l=Math.max(l,e.fromBufferAttribute(r,i).length()||0);a.set(o,l),o.computeBoundingSphere(),o.boundingSphere.radius+=l,o.boundingBox?.expandByScalar(l)}if(!n.isSkinnedMesh)return;let{computeBoundingSphere:s}=n;n.computeBoundingSphere=function(){s.call(this),this.boundingSphere.radius+=a.get(o)}})}var pe=class{constructor(e,{fallback:a=!1}={}){this.name=V,this.parser=e,this.loadsFallback=a,this.maps=[],this.plain=[]}finish(e){Sn(e)}beforeRoot(){let{json:e}=this.parser;return this.maps=(e.materials??[]).map(a=>ct(a,St)),this.plain=e.materials??[],e.materials&&(e.materials=e.materials.map((a,n)=>this.maps[n]?ht(a):a)),null}loadMaterial(e){let a=this.maps[e];return a?this.#e(e,a):null}async#e(e,a){let{parser:n}=this,o=h=>h?n.getDependency("texture",h.index):null,[r,s,l]=await Promise.all([n.loadMaterial(e),o(a.texture),o(a.cutout?.texture)]),i=this.loadsFallback?await this.#t(this.plain[e]):{};try{if(!r.isMeshStandardMaterial)throw new Error("the material is not lit, and this reads lit ones");if(!s?.image||a.cutout&&!l?.image)throw new Error("an image of it cannot be read");let h=a.cutout&&{...a.cutout,texture:yt(l)};return this.give(r,new fe({...a,texture:yt(s),cutout:h}),i)}catch(h){St(`the parallax map of material "${r.name}" was left out: ${h.message}`)}return r}async#t(e){let a=e.extensions[V],n={},o=[["map",a.baseColorTexture,e.pbrMetallicRoughness?.baseColorTexture,wn],["normalMap",a.normalTexture,e.normalTexture]];return await Promise.all(o.filter(([,r,s])=>r&&s).map(([r,,s,l])=>this.parser.assignTexture(n,r,s,l))),n}afterRoot({scenes:e}){for(let a of e)this.finish(a);return null}};var $e=class{#e=!0;constructor(e,a,n){this.material=e,this.maps=a,this.fallback={...n},this.followers=new Set,this.hasTangents=!1,this.hasOffsets=!1,this.isAnisotropic=Mt(e)}get textures(){return[...this.maps.textures,...Object.values(this.fallback).filter(Boolean)]}get enabled(){return this.#e}set enabled(e){if(this.#e!==e){this.#e=e;for(let[a,n]of Object.entries(this.fallback))this.fallback[a]=this.material[a],this.material[a]=n;for(let a of this.followers)a.map=this.material.map;for(let a of[this.material,...this.followers])a.needsUpdate=!0}}get isActive(){return this.#e&&!!(this.material.map||this.material.normalMap)}},Mt=({map:t,normalMap:e})=>t?.anisotropy>1||e?.anisotropy>1,At=t=>!!(t.normalMap||t.anisotropy>0);function yn(t,{material:e,maps:a,hasTangents:n,hasOffsets:o,isAnisotropic:r}){let s=!At(e)&&n,l=e.flatShading,i=!l&&(t.vertexTangents||s),h=["PARALLAX_SHIFT",a.hasCutout&&"PARALLAX_CUTOUT",a.isFading&&"PARALLAX_FADE",l&&"PARALLAX_FLAT",r&&"PARALLAX_ANISOTROPIC",o&&"PARALLAX_OFFSET",i&&"PARALLAX_TANGENT",s&&!l&&"USE_TANGENT"].filter(Boolean),u=`${X(h)}#define PARALLAX_UV ${e.map?"vMapUv":"vNormalMapUv"}
#define PARALLAX_IS_ORTHOGRAPHIC isOrthographic
`;t.vertexShader=X(h)+W(t.vertexShader).replace("void main() {",`${s?`attribute vec4 tangent;
`:""}#ifdef PARALLAX_TANGENT
varying float vParallaxSide;
#endif
void main() {`).replace("#include <normal_vertex>",`#include <normal_vertex>
${ce}`);let f=t.fragmentShader;if(a.hasCutout){let p=!e.transparent&&!(e.alphaTest>0)&&!e.alphaHash;f=f.replace("#include <map_fragment>",`float parallaxClipped = diffuseColor.a;
#include <map_fragment>`).replace("#include <alphahash_fragment>",`#include <alphahash_fragment>
#ifdef ALPHA_TO_COVERAGE
${p?"diffuseColor.a = parallaxClipped * parallaxCoverage;":"diffuseColor.a *= parallaxCoverage;"}
#endif`)}t.fragmentShader=he(f,u,!0)}var Ne=new WeakMap;function Mn(t){let e=t.getRenderTarget();return e?e.samples>0:(Ne.has(t)||Ne.set(t,t.getContext().getContextAttributes().antialias),Ne.get(t))}function de(t,e,{alphaToCoverage:a=!0,fallback:n={}}={}){if(!t.isMeshStandardMaterial)throw new Error("Parallax maps are for MeshStandardMaterial and MeshPhysicalMaterial.");let o=new $e(t,e,n),{onBeforeCompile:r,customProgramCacheKey:s,onBeforeRender:l,clone:i}=t,h=Object.hasOwn(t,"customProgramCacheKey");return t.parallax=o,t.onBeforeCompile=function(u,f){r.call(this,u,f),Object.assign(u.uniforms,e.uniforms),o.isActive&&yn(u,o)},t.customProgramCacheKey=function(){let u=h?s.call(this):r.toString();if(!o.isActive)return u;let f=!this.transparent&&!(this.alphaTest>0)&&!this.alphaHash,p=[!!this.map,o.hasTangents,o.hasOffsets,o.isAnisotropic,e.hasCutout,e.isFading,f].map(Number).join("");return`${u} parallax ${p}`},t.onBeforeRender=function(u,f,p,m,...x){l.call(this,u,f,p,m,...x),e.hasCutout&&(e.uniforms.parallaxIsMultisampled.value=Mn(u));let w={hasTangents:!!m.attributes.tangent&&!At(this),isAnisotropic:Mt(this),hasOffsets:!!m.attributes[L]};Object.entries(w).every(([H,M])=>o[H]===M)||(Object.assign(o,w),this.needsUpdate=!0)},t.clone=function(){let u=i.call(this);if(!u.parallax){let f=o.enabled?o.fallback:Object.fromEntries(Object.keys(o.fallback).map(p=>[p,t[p]]));o.enabled||Object.assign(u,o.fallback),de(u,e,{alphaToCoverage:!1,fallback:f})}return u.parallax.enabled=o.enabled,u},e.hasCutout&&a&&!t.transparent&&(t.alphaToCoverage=!0,Object.assign(t,vt)),t}function me(t){let{onBeforeCompile:e,customProgramCacheKey:a}=t,n=!0;return t.onBeforeCompile=function(o,r){e.call(this,o,r),n&&(o.vertexShader=X(["PARALLAX_OFFSET"])+W(o.vertexShader))},t.customProgramCacheKey=function(){return`${a.call(this)} offsets ${n}`},o=>{o!==n&&(n=o,t.needsUpdate=!0)}}var j=class extends pe{constructor(e,{alphaToCoverage:a=!0,...n}={}){super(e,n),this.alphaToCoverage=a}give(e,a,n){return de(e,a,{alphaToCoverage:this.alphaToCoverage,fallback:n})}finish(e){super.finish(e),gt(e)}};function ge(t){let e=new Set;return t.traverse(a=>{for(let n of[a.material??[]].flat())n.parallax&&e.add(n)}),[...e]}function Ue(t,e){for(let a of ge(t))a.parallax.enabled=e}var kn="PARBAKE_materials_parallax_sh";async function Be(t){let e=fetch(t.notes).then(s=>s.json()).catch(()=>({})),a=await fetch(t.url).catch(()=>{throw new Error("parbake view no longer answers: it was ended, or its address has changed. Start it again.")});if(!a.ok)throw new Error((await e).error??`${t.name}: the viewer answered ${a.status}.`);let n=await a.arrayBuffer(),{warnings:o=[],bytes:r=n.byteLength}=await e;return{entry:t,bytes:n,size:r,notes:[...o]}}function Ct(t){let e,a=new Promise((r,s)=>{e=s});a.catch(()=>{});let n=new Tn().setDecoderPath("draco/"),o=new le(void 0,e).detectSupport(t);return async({entry:r,bytes:s,size:l,notes:i})=>{let h=new Pn;h.onError=()=>{let f=`${r.name}: a texture could not be decoded; its material is shown without it.`;i.includes(f)||i.push(f)};let u=new En(h).setDRACOLoader(n).setKTX2Loader(o).setMeshoptDecoder(Rn).register(f=>new j(f,{fallback:!0}));try{it(s);let f=await Promise.race([u.parseAsync(s,""),a]);return new Ie(r,f,await On(f),l,i)}catch(f){throw new Error(`${r.name}: this file cannot be shown: ${f?.message??f}.`)}}}async function On({parser:t,scene:e}){let a=[];e.traverse(o=>{let r=t.associations.get(o)?.nodes,s=r===void 0?null:t.json.nodes?.[r],l=s?.extensions?.MSFT_lod?.ids;Array.isArray(l)&&l.length&&o.parent&&a.push({object:o,ids:l,definition:s})});let n=[];for(let{object:o,ids:r,definition:s}of a){let l=await Promise.all(r.map(h=>t.getDependency("node",h)));for(let h of l)o.parent.add(h);let i=s.extras?.MSFT_screencoverage;n.push({objects:[o,...l],coverage:Array.isArray(i)?i:null})}return n}var Ie=class{constructor(e,a,n,o,r){this.name=e.name,this.bytes=o,this.notes=r,this.root=new Ln().add(a.scene),this.clips=a.animations,this.mixer=this.clips.length?new An(a.scene):null,this.lodNodes=n,this.levels=Math.max(1,...n.map(l=>l.objects.length)),this.coverage=n[0]?.coverage??null,(a.parser.json.extensionsUsed??[]).includes(kn)&&r.push(`${this.name} has parallax maps of the older kind. This viewer shows the plain material, without their depth.`),this.prepare(),this.parallax=ge(this.root),this.showLevel(0)}prepare(){let e=0;this.hasTransmission=!1,this.hasExtensions=!1,this.root.traverse(a=>{a.isLight&&(a.visible=!1),(a.isPoints||a.isLine)&&e++;for(let n of xe(a))n.transmission>0&&(this.hasTransmission=!0),rt(n),n.isMeshPhysicalMaterial&&(this.hasExtensions=!0)}),e&&this.notes.push(`${this.name}: points and lines are shown, but not counted.`)}showLevel(e){for(let{objects:a}of this.lodNodes){let n=e===null?-1:Math.min(e,a.length-1);a.forEach((o,r)=>{o.visible=r===n})}}setParallax(e){Ue(this.root,e)}dispose(){this.root.traverse(e=>{e.geometry?.dispose();for(let a of xe(e)){let n=se.map(([o])=>a[o]);for(let o of[...n,...a.parallax?.textures??[]])o?.dispose(),o?.source.data?.close?.();st(a),a.dispose()}})}get showsMaps(){return this.parallax.some(e=>e.parallax.enabled)}get isCut(){return this.parallax.some(e=>e.parallax.enabled&&e.alphaToCoverage)}box(){return this.root.updateMatrixWorld(!0),new Cn().setFromObject(this.root,!0)}figures(){let e={triangles:0,vertices:0,materials:0,textures:0,texels:0},a=new Set,n=new Map,o=new Set;this.root.traverseVisible(r=>{if(!r.isMesh)return;let{geometry:s}=r,l=s.attributes.position;if(!l)return;let i=r.isInstancedMesh?r.count:1;e.triangles+=(s.index?s.index.count:l.count)/3*i,o.has(l)||(e.vertices+=l.count),o.add(l);for(let h of xe(r))a.add(h)});for(let r of a)for(let s of[...se.map(([l])=>r[l]),...r.parallax?.textures??[]]){let l=s?.image;l&&n.set(s.source,(l.width||0)*(l.height||0))}e.materials=a.size,e.textures=n.size;for(let r of n.values())e.texels+=r;return e}textures(){let e=new Map;return this.root.traverse(a=>{if(a.isMesh)for(let n of xe(a))for(let[o,r]of se){let s=n[o];if(!s?.image)continue;let l=`${s.source.uuid} ${r}`;e.has(l)||e.set(l,{label:r,material:n.name,texture:s,meshes:new Set}),e.get(l).meshes.add(a)}}),[...e.values()]}meshes(){let e=[];return this.root.traverseVisible(a=>{a.isMesh&&e.push(a)}),e}};function xe(t){return t.material?[t.material].flat():[]}function Tt(t){let e=[];return{get:()=>t,set(a){let n=Object.keys(a).filter(o=>!Object.is(t[o],a[o]));if(n.length){t={...t,...a};for(let{keys:o,call:r}of[...e])o.some(s=>n.includes(s))&&r(t)}},on(a,n){e.push({keys:a,call:n}),n(t)}}}var K=class{constructor(e){this.models=e,this.count=e.length>1?e.length:e[0].levels,this.coverage=e.length>1?null:e[0].coverage,this.shown=0,this.figures=Array.from({length:this.count},(a,n)=>(this.show(n),e.length>1?e[n].figures():e[0].figures())),this.show(0)}show(e){this.shown=e,this.models.length>1?this.models.forEach((a,n)=>{a.root.visible=n===e}):this.models[0].showLevel(e)}model(){return this.models.length>1?this.models[this.shown??0]:this.models[0]}forSize(e,a,n){if(this.coverage){let r=Math.min(1,Math.PI/4*e*e/(a*n)),s=this.coverage.findIndex(l=>r>=l);return s>=0?Math.min(s,this.count-1):this.coverage.length>=this.count?null:this.count-1}let o=Math.floor(Math.log2(.5*Math.min(a,n)/e))+1;return Math.min(this.count-1,Math.max(0,o))}};var c=t=>document.getElementById(t);function Y(t,e,a,n){for(let o of t.querySelectorAll("label"))o.remove();for(let[o,r]of a){let s=document.createElement("label"),l=document.createElement("input"),i=document.createElement("span");Object.assign(l,{type:"radio",name:e,value:o}),l.addEventListener("change",()=>n(o)),i.textContent=r,s.append(l,i),t.append(s)}}function N(t,e){for(let a of t.querySelectorAll("input"))a.checked=a.value===String(e)}function k(t,e){t.replaceChildren(...e.map(([a,n])=>new Option(n,a)))}var Fn=new Intl.NumberFormat("en"),T=t=>Fn.format(Math.round(t));function Et(t){let e=["B","kB","MB","GB"],a=Math.min(3,Math.floor(Math.log10(Math.max(1,t))/3)),n=t/1e3**a;return`${a===0||n>=100?Math.round(n):n>=10?n.toFixed(1):n.toFixed(2)} ${e[a]}`}var _n=140;function Lt(t,e,a){let n=c("loupe");if(n.hidden=!a||e>_n,n.hidden)return;let o=c("loupe-canvas"),r=o.getContext("2d"),s=Math.max(1,Math.floor(o.width/Math.max(16,e*1.1))),l=o.width/s;r.imageSmoothingEnabled=!1;let i=Math.round((t.width-l)/2),h=Math.round((t.height-l)/2);r.drawImage(t,i,h,l,l,0,0,o.width,o.height),c("loupe-text").textContent=`enlarged ${s} times`}function Pt(t,{turn:e,move:a,zoom:n,takesWheel:o=()=>!0}){let r=new Map,s=()=>{let i=[...r.values()],h=i.reduce((p,m)=>p+m.x,0)/i.length,u=i.reduce((p,m)=>p+m.y,0)/i.length,f=i.length>1?Math.hypot(i[0].x-i[1].x,i[0].y-i[1].y):0;return{x:h,y:u,spread:f}};t.addEventListener("pointerdown",i=>{t.setPointerCapture(i.pointerId),r.set(i.pointerId,{x:i.offsetX,y:i.offsetY}),t.classList.add("grabbed")}),t.addEventListener("pointermove",i=>{if(!r.has(i.pointerId))return;let h=s();r.set(i.pointerId,{x:i.offsetX,y:i.offsetY});let u=s(),f=u.x-h.x,p=u.y-h.y;r.size>1?(a(f,p),h.spread>0&&u.spread>0&&n(h.spread/u.spread,u.x,u.y)):i.buttons&6||i.shiftKey||i.ctrlKey||i.metaKey?a(f,p):e(f,p)});let l=i=>{r.delete(i.pointerId),r.size||t.classList.remove("grabbed")};t.addEventListener("pointerup",l),t.addEventListener("pointercancel",l),t.addEventListener("contextmenu",i=>i.preventDefault()),t.addEventListener("wheel",i=>{if(!o())return;i.preventDefault();let h=i.deltaMode===1?16:1;n(Math.exp(Math.max(-120,Math.min(120,i.deltaY*h))*.0018),i.offsetX,i.offsetY)},{passive:!1})}var Nn=[["page","As the page"],["black","Black"],["grey","Grey"],["white","White"]],Rt=[["model","Model"],["high","High-poly"],["split","Split"],["side","Side by side"],["difference","Difference"],["uv","UV layout"]],kt=t=>!["model","uv"].includes(t);function Ot(t){Y(c("channels"),"channel",D.map(e=>[e.key,e.label]),e=>t.set({channel:e})),k(c("light"),G.map(e=>[e.key,e.label])),k(c("tone"),ne),k(c("background"),Nn);for(let e of["light","tone","background"])c(e).addEventListener("change",a=>t.set({[e]:a.target.value}));for(let e of["wireframe","parallax","turntable","uvLines"])c(e).addEventListener("change",a=>t.set({[e]:a.target.checked}));for(let e of["turn","exposure"])c(e).addEventListener("input",a=>t.set({[e]:Number(a.target.value)}));t.on(["mode"],({mode:e})=>{N(c("modes"),e),c("uv-section").hidden=e!=="uv",c("divider").hidden=e!=="side";for(let a of document.querySelectorAll(".scene-only"))a.hidden=e==="uv"}),t.on(["channel"],({channel:e})=>N(c("channels"),e)),t.on(["light","tone","background"],e=>{for(let a of["light","tone","background"])c(a).value=e[a]}),t.on(["wireframe","parallax","turntable","uvLines"],e=>{for(let a of["wireframe","parallax","turntable","uvLines"])c(a).checked=e[a]}),t.on(["turn","exposure"],({turn:e,exposure:a})=>{c("turn").value=e,c("exposure").value=a,c("turn-value").textContent=`${e}°`,c("exposure-value").textContent=`${a>0?"+":""}${a} EV`})}function Ft(t,e,a){let n=[["Triangles",r=>T(r.triangles)],["Vertices",r=>T(r.vertices)],["Draw calls",r=>r.drawCalls?T(r.drawCalls):"–"],["Materials",r=>T(r.materials)],["Textures",r=>T(r.textures)],["Texels",r=>T(r.texels)],["File",r=>r.bytes===null?"–":Et(r.bytes)]],o=c("figures").tBodies[0];for(let r of c("figures").querySelectorAll(".second"))r.hidden=!e;o.replaceChildren(...[...n.map(([r,s])=>[r,s(t),e?s(e):null]),a].filter(Boolean).map(([r,...s])=>{let l=document.createElement("tr"),i=document.createElement("th");i.scope="row",i.textContent=r,l.append(i);for(let h of s)h!==null&&(l.insertCell().textContent=h);return l}))}function _t(t){c("notes-section").hidden=t.length===0,c("notes").replaceChildren(...t.map(e=>{let a=document.createElement("li");return a.textContent=e,a}))}var $n=20,Un=8e3,Ut=60,In=2500,Bn="The bake was ended before it was finished.",Dn=5,Gn=2e3;async function It({tell:t,canShow:e,show:a,others:n}){let o={version:0},r=0,s=0,l=!0,i=0;for(;;){let h=e()&&performance.now()>=s?"look":"news",u=await fetch(`run/${h}/${o.version}`).then(p=>p.json()).catch(()=>null);if(i=u?0:i+1,i&&i<=Dn){await new Promise(p=>setTimeout(p,1e3));continue}o=u??{...o,failure:Bn},t(o);let f=o.isFinished||o.failure;if(o.snapshot>r&&(h==="look"||f)){let p=f&&setInterval(()=>fetch(`run/news/${o.version}`).catch(()=>{}),Gn),m=await fetch("run/snapshot").then(x=>x.ok?x.arrayBuffer():null).catch(()=>null);if(m){r=o.snapshot;let{took:x,...w}=await a(m,o);s=performance.now()+Math.min(Un,$n*x),l=w.isSlow}clearInterval(p)}if(!f){l&&performance.now()<s&&await new Promise(p=>setTimeout(p,In));continue}await n,await fetch("run/shown").catch(()=>{});return}}function Ge(){let t={};return t.promise=new Promise((e,a)=>Object.assign(t,{resolve:e,reject:a})),t}var zn=t=>t[0].toUpperCase()+t.slice(1),Nt=t=>`${Math.round(100*t)} %`,$t=t=>t<90?`${Math.round(t)} s`:`${Math.round(t/60)} min`;function Bt(t,e){let{stage:a,part:n,done:o,secondsLeft:r,seconds:s,curves:l=[],isFinished:i,failure:h}=e,u=r==null?"":`, ${$t(r)} left`,f=h?"Failed":i?`Finished in ${$t(s)}`:[n,a].filter(Boolean).join(": ")||"Starting",p=zn(f);c("run-section").hidden=!1,c("run-stage").textContent!==p&&(c("run-stage").textContent=p);let m=i?1:o??0;c("run-progress").value=m,c("run-progress").hidden=!!h;let x=i||h||o===null||o===void 0?"":Nt(o)+u;c("run-left").textContent=x&&u.slice(2),c("run-reading").hidden=!1,c("run-reading").classList.toggle("failed",!!h),c("run-text").textContent=[p,x].filter(Boolean).join(", "),document.title=`${h?"Failed":i?"Finished":Nt(m)} – ${t} – Parbake`,Gt(l)}var De="",Dt=[];new ResizeObserver(()=>{De="",Gt(Dt)}).observe(c("run-figure"));function Gt(t){Dt=t;let e=t.map(Vn).filter(n=>n.points.length>1);c("run-figure").hidden=e.length===0;let a=JSON.stringify([e.length,e.at(-1)?.points,document.documentElement.dataset.theme]);!e.length||a===De||!c("run-chart").clientWidth||(De=a,Xn(c("run-chart"),e))}function Vn({stage:t,points:e}){let a=Math.floor(e.length/16),n=(s,l)=>{let i=e.slice(Math.max(0,s),l+1);return i.reduce((h,[,u])=>h+u,0)/i.length},o=n(0,a),r=(s,l)=>n(l-a,l+a)/o;return{stage:t,points:o>0?e.map(([s],l)=>[s,r(null,l)]):[]}}function Xn(t,e){let a=window.devicePixelRatio||1,[n,o]=[t.clientWidth,t.clientHeight];Object.assign(t,{width:Math.round(n*a),height:Math.round(o*a)});let r=t.getContext("2d"),s=getComputedStyle(t),[l,i]=[e[0].points[0][0],e.at(-1).points.at(-1)[0]],h=Math.min(.5,...e.flatMap(({points:p})=>p.map(([,m])=>m)).filter(p=>p>0)),u=p=>2+(p-l)/Math.max(.001,i-l)*(n-4),f=p=>2+Math.min(1,Math.max(0,Math.log(Math.max(p,h))/Math.log(h)))*(o-4);r.scale(a,a),r.lineWidth=1,r.strokeStyle=s.getPropertyValue("--line"),r.beginPath();for(let p of[2,o-2])r.moveTo(0,p),r.lineTo(n,p);r.stroke(),r.lineWidth=1.5,r.lineJoin="round",e.forEach(({points:p},m)=>{r.strokeStyle=s.getPropertyValue(m===e.length-1?"--accent":"--muted"),r.beginPath();for(let[x,w]of p)r.lineTo(u(x),f(w));r.stroke()})}import{Color as lo,CustomBlending as co,DoubleSide as ho,EqualDepth as uo,FloatType as fo,HalfFloatType as po,MeshBasicMaterial as jt,OneFactor as Kt,Scene as Yt,UnsignedByteType as mo,Vector3 as Qt,WebGLRenderer as go,WebGLRenderTarget as Ve,ZeroFactor as Jt}from"./three.js";var ve=class{constructor(e){this.gl=e,this.extension=e.getExtension("EXT_disjoint_timer_query_webgl2"),this.pending=null,this.milliseconds=null}get isAvailable(){return this.extension!==null}run(e){let{gl:a,extension:n}=this;if(this.poll(),!n||this.pending)return e();let o=a.createQuery();a.beginQuery(n.TIME_ELAPSED_EXT,o),e(),a.endQuery(n.TIME_ELAPSED_EXT),this.pending=o}poll(){let{gl:e,extension:a,pending:n}=this;return!n||!e.getQueryParameter(n,e.QUERY_RESULT_AVAILABLE)?n!==null:(e.getParameter(a.GPU_DISJOINT_EXT)||(this.milliseconds=e.getQueryParameter(n,e.QUERY_RESULT)/1e6),e.deleteQuery(n),this.pending=null,!1)}};import{BufferAttribute as zt,BufferGeometry as Hn,Color as qn,DataTexture as Wn,LineSegments as jn,Mesh as Kn,OrthographicCamera as Yn,PlaneGeometry as Qn,Scene as Jn,ShaderMaterial as Vt,SRGBColorSpace as Zn,Vector2 as Ht}from"./three.js";var Xt="varying vec2 at; void main() { at = uv; gl_Position = projectionMatrix * modelViewMatrix * vec4(position, 1.0); }",eo=`
uniform sampler2D map; uniform bool isColor; uniform float light; varying vec2 at;
void main() {
  vec3 c = texture2D(map, vec2(at.x, 1.0 - at.y)).rgb;
  if (isColor) c = mix(12.92 * c, 1.055 * pow(max(c, 0.0), vec3(1.0 / 2.4)) - 0.055, step(0.0031308, c));
  gl_FragColor = vec4(light * c, 1.0);
}`,to="uniform vec3 ink; uniform float opacity; void main() { gl_FragColor = vec4(ink, opacity); }",ao=.55,no=[1,.56,.3],we=class{constructor(){this.scene=new Jn,this.camera=new Yn(-1,1,1,-1,-1,1),this.center=new Ht(.5,.5),this.span=1.15,this.blank=new Wn(new Uint8Array([128,128,128,255]),1,1),this.blank.needsUpdate=!0,this.paper=new Vt({uniforms:{map:{value:this.blank},isColor:{value:!1},light:{value:1}},vertexShader:Xt,fragmentShader:eo}),this.ink=new Vt({uniforms:{ink:{value:new qn(...no)},opacity:{value:1}},vertexShader:Xt,fragmentShader:to,depthTest:!1,depthWrite:!1,transparent:!0});let e=new Kn(new Qn(1,1),this.paper);e.position.set(.5,.5,-.5),this.scene.add(e),this.lines=[]}show(e,a){let{texture:n}=e??{};this.paper.uniforms.map.value=n??this.blank,this.paper.uniforms.isColor.value=n?.colorSpace===Zn;for(let r of this.lines)this.scene.remove(r),r.geometry.dispose();this.lines=[];for(let r of e?e.meshes:a){let s=oo(r.geometry,n,this.ink);s&&this.lines.push(s)}this.lines.length&&this.scene.add(...this.lines);let o=this.lines.reduce((r,s)=>r+s.geometry.index.count/6,0);this.ink.uniforms.opacity.value=Math.max(.15,Math.min(.9,60/Math.sqrt(o+1)))}showLines(e){for(let a of this.lines)a.visible=e;this.paper.uniforms.light.value=e?ao:1}move(e,a,n){this.center.x-=e/n*this.span,this.center.y+=a/n*this.span}zoom(e,a,n){let o=Math.min(40,Math.max(.005,this.span*e)),r=this.span-o;this.center.x+=a*r,this.center.y-=n*r,this.span=o}fit(){this.center.set(.5,.5),this.span=1.15}at(e){let[a,n]=e>=1?[e,1]:[1,1/e],{x:o,y:r}=this.center,s=this.span/2;return Object.assign(this.camera,{left:o-a*s,right:o+a*s,top:r+n*s,bottom:r-n*s}),this.camera.updateProjectionMatrix(),this.camera}};function oo(t,e,a){let n=t.attributes[e?.channel?`uv${e.channel}`:"uv"];if(!n)return null;e?.updateMatrix();let o=new Float32Array(3*n.count),r=new Ht;for(let f=0;f<n.count;f++)r.fromBufferAttribute(n,f),e&&r.applyMatrix3(e.matrix),o.set([r.x,1-r.y,0],3*f);let{index:s}=t,l=Math.floor((s?s.count:n.count)/3),i=new Uint32Array(6*l);for(let f=0;f<l;f++){let[p,m,x]=[0,1,2].map(w=>s?s.getX(3*f+w):3*f+w);i.set([p,m,m,x,x,p],6*f)}let h=new Hn;h.setAttribute("position",new zt(o,3)),h.setIndex(new zt(i,1));let u=new jn(h,a);return u.frustumCulled=!1,u.renderOrder=1,u}import{PerspectiveCamera as ro,Vector3 as be}from"./three.js";var ze=43.602818,so=400,io=.02,qt=1.55,Se=class{constructor(){this.camera=new ro(ze,1,.05,50),this.azimuth=.5,this.elevation=.3,this.distance=3.5,this.target=new be,this.radius=1}halfAngle(){return ze/2*(Math.PI/180)}orbit(e,a){this.azimuth+=e,this.elevation=Math.min(qt,Math.max(-qt,this.elevation+a))}zoom(e){this.distance=Math.min(so,Math.max(io,this.distance*e))}pan(e,a){let n=2*Math.tan(this.halfAngle())*this.distance,o=new be().setFromMatrixColumn(this.camera.matrixWorld,0),r=new be().setFromMatrixColumn(this.camera.matrixWorld,1);this.target.addScaledVector(o,-e*n).addScaledVector(r,a*n)}fit(){this.target.set(0,0,0),this.distance=this.radius/Math.sin(this.halfAngle())*1.08}pixels(e){let a=Math.max(this.distance,this.radius*1.0001);return e*this.radius/(Math.tan(this.halfAngle())*Math.sqrt(a*a-this.radius*this.radius))}setPixels(e,a){let n=a/(e*Math.tan(this.halfAngle()));this.distance=this.radius*Math.sqrt(1+n*n)}at(e){let{camera:a,distance:n}=this,o=new be(Math.sin(this.azimuth)*Math.cos(this.elevation),Math.sin(this.elevation),Math.cos(this.azimuth)*Math.cos(this.elevation));a.aspect=e,a.fov=e>=1?ze:2*Math.atan(Math.tan(this.halfAngle())/e)*(180/Math.PI),a.position.copy(this.target).addScaledVector(o,n),a.lookAt(this.target);let r=this.radius*1.5+this.target.length();return a.near=Math.max(n-r,n*.01,.001),a.far=n+r,a.updateProjectionMatrix(),a.updateMatrixWorld(),a}};function Wt(t,e){let a=0;for(let n=0;n<t.length;n+=4){let o=t[n]-e[n],r=t[n+1]-e[n+1],s=t[n+2]-e[n+2];a+=o*o+r*r+s*s}return 10*Math.log10(65025/(a/(t.length/4*3)))}var xo=9e6,vo=4e6,ye=class{constructor(e){this.canvas=e,this.renderer=new go({canvas:e,antialias:!1,alpha:!1,powerPreference:"high-performance"}),this.renderer.setPixelRatio(1),this.renderer.info.autoReset=!0,this.composer=new ae(this.renderer),this.timer=new ve(this.renderer.getContext()),this.scenes=[new Yt,new Yt],this.lights=new ie(this.renderer,this.scenes),this.view=new Se,this.uv=new we,this.wire=new jt({wireframe:!0,transparent:!0,opacity:.55,depthWrite:!1}),this.cover=new jt({side:ho,depthFunc:uo,depthWrite:!1,blending:co,blendSrc:Jt,blendDst:Kt,blendSrcAlpha:Kt,blendDstAlpha:Jt}),this.cover.onBeforeCompile=a=>{a.fragmentShader="void main() { gl_FragColor = vec4(1.0); }"},me(this.cover),this.wireFollows=me(this.wire),this.targets=[null,null],this.measured=[null,null],this.levels=null,this.compare=null,this.drawCalls=[0,0],this.milliseconds=null,this.sharpness=1}setModels(e,a){this.compare=a;let n=(a??e.models[0]).box(),o=n.getSize(new Qt),r=Math.max(o.x,o.y,o.z);if(!(r>0)||!Number.isFinite(r))throw new Error("The model has no size: all its vertices lie at one point.");this.frame={center:n.getCenter(new Qt),scale:2/r},nt(this.frame.scale),this.setLevels(e),a&&this.place(a,1),this.view.radius=this.frame.scale*o.length()/2,this.view.fit()}setLevels(e){for(let a of this.levels?.models??[])this.scenes[0].remove(a.root);this.levels=e;for(let a of e.models)this.place(a,0)}place(e,a){let{center:n,scale:o}=this.frame;e.root.scale.setScalar(o),e.root.position.copy(n).multiplyScalar(-o),e.root.updateMatrixWorld(!0),this.scenes[a].add(e.root)}resize(){let{clientWidth:e,clientHeight:a}=this.canvas,n=this.sharpness*Math.min(window.devicePixelRatio||1,Math.sqrt(xo/Math.max(1,e*a))),o=Math.max(1,Math.round(e*n)),r=Math.max(1,Math.round(a*n));return this.width===o&&this.height===r?!1:(Object.assign(this,{width:o,height:r,ratio:n}),this.renderer.setSize(o,r,!1),!0)}part(e){return e===b.side?[Math.max(1,Math.floor(this.width/2)),this.height]:[this.width,this.height]}target(e,a,n){let o=a*n>vo?2:4,r=this.targets[e];return r?.samples!==o&&(r?.dispose(),r=new Ve(a,n,{type:po,samples:o}),this.targets[e]=r),r.setSize(a,n),r}choose({light:e,channel:a,turn:n}){let o=D.find(l=>l.key===a),r=G.find(l=>l.key===e);this.lights.choose(e,n),ot(n);let s=o.key==="lit"?r.shaded:o.code;return this.showsGlass=ke(s),tt(s),o.isColor??!1}picture(e,a,n,{wireframe:o,ink:r,background:s}){let l=this.scenes[e],{renderer:i}=this,h=e===0?this.levels.models:[this.compare];l.background=this.showsGlass&&h.some(u=>u.hasTransmission)?new lo().setRGB(...s,"srgb"):null,i.setRenderTarget(a),i.setClearColor(0,0),i.autoClear=!0,wo(h,o),i.render(l,n),this.drawCalls[e]=i.info.render.calls,a.samples>0&&h.some(u=>u.isCut)&&(Object.assign(this.cover,{polygonOffset:o,...Zt}),this.over(l,n,this.cover)),o&&(this.wire.color.set(r),this.wireFollows(h.some(u=>u.showsMaps)),this.over(l,n,this.wire))}over(e,a,n){this.renderer.autoClear=!1,e.background=null,e.overrideMaterial=n,this.renderer.render(e,a),e.overrideMaterial=null,this.renderer.autoClear=!0}draw(e){let{layout:a,uv:n}=e;if(n)return this.drawUv(e);let o=this.choose(e),[r,s]=this.part(a),l=this.view.at(r/s),i={[b.first]:[0],[b.second]:[1]}[a]??[0,1],h=performance.now();for(let u of i){let f=()=>this.picture(u,this.target(u,r,s),l,e);u===i[0]?this.timer.run(f):f()}this.composer.draw({first:this.targets[0]?.texture??null,second:this.targets[1]?.texture??null,layout:a,isColor:o,tone:e.tone,split:e.split,exposure:e.exposure,background:e.background}),this.milliseconds=performance.now()-h}finish(){let e=this.renderer.getContext();e.readPixels(0,0,1,1,e.RGBA,e.UNSIGNED_BYTE,new Uint8Array(4))}drawUv({background:e,uvLines:a}){let{renderer:n}=this,o=this.target(0,this.width,this.height);this.uv.showLines(a),n.setRenderTarget(o),n.setClearColor(0,0),n.render(this.uv.scene,this.uv.at(this.width/this.height)),this.composer.draw({first:o.texture,layout:b.first,isColor:!1,background:e})}async measure(e){let a=this.choose(e),[n,o]=this.part(e.layout),r=this.view.at(n/o),s=[];for(let i of[0,1]){let h=this.target(i,n,o);this.picture(i,h,r,{...e,wireframe:!1}),this.measured[i]??=new Ve(n,o,{type:mo,depthBuffer:!1}),this.measured[i].setSize(n,o),this.composer.draw({first:h.texture,layout:b.first,isColor:a,tone:e.tone,exposure:e.exposure,background:e.background},this.measured[i]),s.push(new Uint8Array(4*n*o))}let l=i=>this.renderer.readRenderTargetPixelsAsync(this.measured[i],0,0,n,o,s[i]);return await Promise.all([l(0),l(1)]),Wt(s[0],s[1])}still({direction:e,size:a=256,supersample:n=2,radius:o=3.5,which:r=0,light:s="studio",channel:l="lit",background:i=0}){let h=this.choose({light:s,channel:l,turn:0}),u=M=>h?M>.0031308?1.055*M**(1/2.4)-.055:12.92*M:M,f=a*n,p=new Ve(f,f,{type:fo}),m=this.view.at(1).clone();m.position.set(...e).normalize().multiplyScalar(o),m.up.set(0,1,0),m.lookAt(0,0,0),m.near=.05,m.far=o+4,m.updateProjectionMatrix(),m.updateMatrixWorld(),this.renderer.transmissionResolutionScale=1/n;try{this.picture(r,p,m,{wireframe:!1,background:Array(3).fill(u(i))})}finally{this.renderer.transmissionResolutionScale=1}let x=new Float32Array(4*f*f);this.renderer.readRenderTargetPixels(p,0,0,f,f,x),p.dispose();let w=new Uint8ClampedArray(4*a*a),H=1/(n*n);for(let M=0;M<a;M++)for(let ee=0;ee<a;ee++){let Le=[0,0,0,0];for(let P=0;P<n;P++)for(let Pe=0;Pe<n;Pe++){let ga=4*((f-1-(M*n+P))*f+ee*n+Pe);for(let te=0;te<4;te++)Le[te]+=x[ga+te]*H}let Qe=4*(M*a+ee);for(let P=0;P<3;P++)w[Qe+P]=255*u(Le[P]+(1-Le[3])*i);w[Qe+3]=255}return w}},Zt={polygonOffsetFactor:1,polygonOffsetUnits:1};function wo(t,e){for(let a of t)!a||a.isOffset===e||(a.isOffset=e,a.root.traverse(n=>{for(let o of[n.material??[]].flat())Object.assign(o,{polygonOffset:e,...Zt})}))}function Xe(t){return[1,3,5].map(e=>parseInt(t.slice(e,e+2),16)/255)}function ea(t){let e=[],a=!1,n=0,o=0,r=0,s=()=>{for(let u of e)u.mixer.setTime(Math.min(o,r));c("time").value=r?o/r:0,c("time-value").textContent=`${o.toFixed(1)} s`,t()},l=u=>{r=0,o=0;for(let f of e){f.mixer.stopAllAction();let p=f.clips.find((m,x)=>(m.name||`Clip ${x+1}`)===u);p&&(f.mixer.clipAction(p).play(),r=Math.max(r,p.duration))}s()},i=u=>{a&&(o=r?(o+(u-n)/1e3)%r:0,n=u,s(),requestAnimationFrame(i))},h=u=>{u&&e.length&&!r&&l(c("clip").value),a=u&&e.length>0,c("play").setAttribute("aria-label",a?"Pause":"Play"),c("play-icon").setAttribute("href",a?"#icon-pause":"#icon-play"),n=performance.now(),a&&requestAnimationFrame(i),t()};return c("clip").addEventListener("change",u=>l(u.target.value)),c("play").addEventListener("click",()=>h(!a)),c("time").addEventListener("input",u=>{h(!1),r||l(c("clip").value),o=u.target.value*r,s()}),{isPlaying:()=>a,toggle:()=>h(!a),setModels(u){for(let p of e)p.mixer.stopAllAction();e=u.filter(p=>p.clips.length),[o,r]=[0,0],h(!1),s();let f=new Set(e.flatMap(p=>p.clips.map((m,x)=>m.name||`Clip ${x+1}`)));k(c("clip"),[...f].map(p=>[p,p])),c("animation-section").hidden=e.length===0}}}function ta(t,e){document.addEventListener("keydown",r=>{if(r.ctrlKey||r.metaKey||r.altKey||c("help").open)return;let{target:s}=r;if(s===c("canvas")&&e(r))return r.preventDefault();if(s.matches('select, input[type="text"], input[type="number"]')||s.matches("input, button")&&[" ","Enter"].includes(r.key))return;let l=r.key.length===1?r.key.toLowerCase():r.key,i=t.find(([h])=>h.includes(l));i&&(r.preventDefault(),i[2](l))});let a=c("shortcuts"),n=(r,s)=>{let l=document.createElement("dt"),i=document.createElement("dd");for(let h of r){let u=document.createElement("kbd");u.textContent=h===" "?"Space":h.length===1?h.toUpperCase():h,l.append(u)}i.textContent=s,a.append(l,i)};n(["←","→","↑","↓"],"Turn, with the picture in focus"),n(["+","−"],"Zoom, with the picture in focus");for(let[r,s]of t)n(r,s);let o=c("help");c("help-open").addEventListener("click",()=>o.showModal()),c("help-close").addEventListener("click",()=>o.close()),o.addEventListener("click",r=>{r.target===o&&o.close()})}function aa(t){let e=c("splitter"),a=n=>t.set({split:Math.min(.98,Math.max(.02,n))});e.addEventListener("pointerdown",n=>{e.setPointerCapture(n.pointerId),e.focus({focusVisible:!1}),n.preventDefault()}),e.addEventListener("pointermove",n=>{if(!e.hasPointerCapture(n.pointerId))return;let{left:o,width:r}=e.parentElement.getBoundingClientRect();a((n.clientX-o)/r)}),e.addEventListener("keydown",n=>{let o={ArrowLeft:-.02,ArrowRight:.02,ArrowDown:-.02,ArrowUp:.02,PageDown:-.1,PageUp:.1},{split:r}=t.get();if(n.key in o)a(r+o[n.key]);else if(n.key==="Home"||n.key==="End")a(n.key==="Home"?0:1);else return;n.preventDefault(),n.stopPropagation()}),t.on(["split","mode"],({split:n,mode:o})=>{e.hidden=o!=="split",e.style.left=`${100*n}%`,e.setAttribute("aria-valuenow",String(Math.round(100*n))),e.setAttribute("aria-valuetext",`${Math.round(100*n)} percent model`)})}function na(t){let e=matchMedia("(prefers-color-scheme: dark)"),a=!1,n=()=>{a||t.set({theme:e.matches?"dark":"light"})};e.addEventListener("change",n),t.on(["theme"],({theme:o})=>{document.documentElement.dataset.theme=o}),n(),c("theme").addEventListener("click",()=>{a=!0,t.set({theme:t.get().theme==="dark"?"light":"dark"})})}var ia=250,bo=8e3,So=["mode","channel","wireframe","parallax","light","turn","exposure","tone","background","split","level","theme","uvLines"],d=Tt({mode:"model",channel:"lit",wireframe:!1,parallax:!0,light:"studio",turn:0,exposure:0,tone:"none",background:"page",split:.5,level:"auto",turntable:!1,uvLines:!0,theme:"light",isReady:!1,hasCompare:!1}),la=Ge(),oa=t=>getComputedStyle(document.documentElement).getPropertyValue(t).trim(),g,J,v=null,S=null,Ae=0,Q=0,Ce=0,ca=0,qe=[],Ye=!1,Z=[],$=!1,We=!1,ra=null,ha=[];function ua(){let t=d.get(),e={page:Xe(oa("--viewport")),black:[0,0,0],white:[1,1,1],grey:Xe("#bcbcbc")}[t.background];return{layout:{high:b.second,split:b.split,side:b.side,difference:b.difference}[t.mode]??b.first,uv:t.mode==="uv",channel:t.channel,light:t.light,turn:t.turn*Math.PI/180,wireframe:t.wireframe,ink:oa("--wire"),exposure:2**t.exposure,tone:ne.findIndex(([a])=>a===t.tone),split:t.split,background:e,uvLines:t.uvLines}}function Te(){if(Ae=0,!d.get().isReady)return;g.resize();let{level:t}=d.get(),e=Math.min(g.width,g.height),a=g.view.pixels(e),n=t==="auto"?v.forSize(a,g.width,g.height):t;n!==v.shown&&v.show(n),g.draw(ua()),ha.splice(0).forEach(o=>o.dispose()),Lt(c("canvas"),a,["model","high","split","difference"].includes(d.get().mode)),Co(a,e),To(),clearTimeout(Q),Q=0,!J.isPlaying()&&!d.get().turntable&&(Q=setTimeout(yo,ia))}async function yo(){Q=0;let t=++Ce,e=g.timer.poll();He();let{mode:a,hasCompare:n}=d.get();if(n&&a!=="uv"&&!$){let o=await g.measure(ua());if(t!==Ce)return;c("psnr").textContent=Number.isFinite(o)?`${o.toFixed(2)} dB`:"the same picture",c("reading").hidden=!1,He()}e&&setTimeout(()=>{g.timer.poll(),He()},ia),ca=t}async function Mo(){do await new Promise(t=>setTimeout(t,20));while(Ae||Q||ca!==Ce)}function y(){Ce++,Ae||(Ae=requestAnimationFrame(Te))}function Me(t){t!==$&&($=t,g.sharpness=$?.5:1,y())}function Ao(){let t=performance.now();return Te(),g.finish(),performance.now()-t}function Co(t,e){let[a,n]=[12,e*8];c("size").value=1e3*Math.log(t/a)/Math.log(n/a),c("size-value").textContent=`${T(t)} px`,c("size").setAttribute("aria-valuetext",`${Math.round(t)} pixels`)}function To(){let{mode:t,hasCompare:e}=d.get(),a=["split","side"].includes(t),[n,o]=[c("label-first"),c("label-second")],r=v.count>1?v.shown===null?", too small to be drawn":`, level ${v.shown}`:"",s=v.shown===null?0:v.figures[v.shown].triangles;n.hidden=!(a||v.count>1)||t==="uv"||t==="high",n.textContent=`${v.model().name}${r} · ${T(s)} triangles`,o.hidden=!e||!(a||t==="high"),e&&(o.textContent=`${S.name} · ${T(S.known.triangles)} triangles`)}function He(){let t={triangles:0,vertices:0,materials:0,textures:0,texels:0},e={...v.shown===null?t:v.figures[v.shown],bytes:v.model().bytes,drawCalls:g.drawCalls[0]},a=S&&{...S.known,bytes:S.bytes,drawCalls:g.drawCalls[1]},{timer:n,milliseconds:o}=g,r=n.isAvailable?["GPU time",n.milliseconds===null?"–":`${n.milliseconds.toFixed(2)} ms`]:["Frame",o===null?"–":`${o.toFixed(1)} ms`];Ft(e,a,r)}function fa(){let t=[];for(let[r,s]of[["Model",v.model()],["High-poly",S]]){if(!s)continue;let l=s.textures();for(let i of l){let{width:h,height:u}=i.texture.image;t.push({model:s,owner:r,entry:i,label:`${i.label}, ${h} × ${u} (${[r,i.material].filter(Boolean).join(", ")})`})}l.length||t.push({model:s,owner:r,entry:null,label:`No texture (${r})`})}let e=(r,s)=>r.entry?.label===s?.entry?.label&&r.owner===s?.owner,a=qe[c("texture").value];[qe,Ye]=[t,!0];let n=t.map(r=>r.label);n.join(`
`)!==[...c("texture").options].map(r=>r.text).join(`
`)&&k(c("texture"),n.map((r,s)=>[s,r]));let o=Math.max(0,t.findIndex(r=>e(r,a)));c("texture").value=o,pa(o)}function pa(t){let{model:e,entry:a}=qe[t];g.uv.show(a,e.meshes()),y()}function da(t){c("message").hidden=!0,c("failure").hidden=!1,c("failure-text").textContent=t.message??String(t),We&&(c("failure-title").textContent="The bake has failed"),c("failure-hint").hidden=We,document.body.classList.add("failed"),c("panel-toggle").hidden=!0}function je(t){c("banner-text").textContent=t,c("banner").hidden=!1}function Eo(){let t=c("canvas"),e=()=>Math.min(t.clientWidth,t.clientHeight),a=()=>d.get().mode==="uv";Pt(t,{turn(n,o){a()?g.uv.move(n,o,e()):g.view.orbit(-n*.008,o*.008),y()},move(n,o){a()?g.uv.move(n,o,e()):g.view.pan(n/e(),o/e()),y()},zoom(n,o,r){a()?g.uv.zoom(n,(o-t.clientWidth/2)/e(),(r-t.clientHeight/2)/e()):g.view.zoom(n),y()}}),t.addEventListener("dblclick",Ke);for(let n of["fit","fit-uv"])c(n).addEventListener("click",Ke);c("size").addEventListener("input",n=>{let o=Math.min(g.width,g.height),[r,s]=[12,o*8];g.view.setPixels(r*(s/r)**(n.target.value/1e3),o),y()}),c("texture").addEventListener("change",n=>pa(Number(n.target.value))),new ResizeObserver(y).observe(t)}function Ke(){d.get().mode==="uv"?g.uv.fit():g.view.fit(),y()}function Lo({key:t}){let e=d.get().mode==="uv",a=.12,n={ArrowLeft:[-1,0],ArrowRight:[1,0],ArrowUp:[0,1],ArrowDown:[0,-1]};if(n[t]){let[o,r]=n[t];e?g.uv.move(-40*o,40*r,1e3):g.view.orbit(o*a,r*a)}else if(t==="+"||t==="="||t==="-"){let o=t==="-"?1.15:.8695652173913044;e?g.uv.zoom(o,0,0):g.view.zoom(o)}else return!1;return y(),!0}function sa(t,e){let a=e.indexOf(d.get()[t]);d.set({[t]:e[(a+1)%e.length]})}function Po(t){let e=o=>{document.body.classList.toggle("panel-closed",!o),c("panel-toggle").setAttribute("aria-expanded",String(o)),y()},a=()=>e(document.body.classList.contains("panel-closed"));c("panel-toggle").addEventListener("click",a),e(!matchMedia("(max-width: 760px)").matches);let n=o=>{if(v.count<2)return;let r=d.get().level==="auto"?v.shown??v.count-1:d.get().level;d.set({level:Math.min(v.count-1,Math.max(0,r+o))})};ta([[t.map((o,r)=>String(r+1)),"Views, from left to right",o=>d.set({mode:t[Number(o)-1]})],[["c"],"Next channel",()=>sa("channel",D.map(o=>o.key))],[["l"],"Next light",()=>sa("light",G.map(o=>o.key))],[["w"],"Wireframe",()=>d.set({wireframe:!d.get().wireframe})],[["d"],"Parallax maps",()=>{c("parallax-switch").hidden||d.set({parallax:!d.get().parallax})}],[["r"],"Turntable",()=>d.set({turntable:!d.get().turntable})],[["f"],"Fit to view",Ke],[["[","]"],"Finer or coarser level of detail",o=>n(o==="["?-1:1)],[[" "],"Play or pause the animation",()=>J.toggle()],[["t"],"Light or dark",()=>c("theme").click()],[["p"],"Settings",a],[["?"],"This help",()=>c("help").showModal()]],Lo)}function Ro(){let t=0,e=a=>{d.get().turntable&&(g.view.orbit(Math.min(.1,(a-t)/1e3)*.6,0),t=a,y(),requestAnimationFrame(e))};d.on(["turntable"],({turntable:a})=>{t=performance.now(),a&&requestAnimationFrame(e)})}function ma(){let t=c("levels");t.hidden=v.count<2;let e=v.figures.map((a,n)=>[n,`${n}: ${T(a.triangles)}`]);Y(t,"level",[["auto","By size"],...e],a=>d.set({level:a})),N(t,d.get().level)}async function ko(){let t=await fetch("session.json").then(o=>o.json()).catch(()=>{throw new Error("parbake view no longer answers: it was ended. Start it again.")}),e=t.models.filter(o=>o.role==="level"),a=t.models.find(o=>o.role==="compare"),{name:n}=t.live??e[0];return We=!!t.live,c("version").textContent=`Parbake ${t.version}.`,c("title").textContent=n,c("subtitle").textContent=a?`compared with ${a.name}`:"",document.title=`${n} – Parbake`,c("spinner").hidden=!!t.live,c("message-text").textContent=t.live?"The bake begins":`Reading ${e.map(o=>o.name).join(", ")}`,{files:e,other:a,run:t.live??null}}async function Oo({files:t,other:e,run:a}){let n=t.map(Be),o=e&&Be(e);for(let f of[...n,o])f?.catch(()=>{});try{g=new ye(c("canvas"))}catch{throw new Error("This browser has no WebGL 2, or it is switched off. Turn on hardware acceleration, or use another browser.")}let r=Ct(g.renderer),s=o?o.then(r).catch(f=>f):null,l=Promise.allSettled([o]),i=a?[await Fo(a,r,l)]:await Promise.all(n.map(f=>f.then(r))),h=await s,u=h instanceof Error?h.message:null;return S=u?null:h,v=new K(i),S&&(S.known=S.figures()),g.setModels(v,S),u}function Fo(t,e,a){let n=Ge(),o=!0,r=1/0,s=i=>{Bt(t.name,i),Z=i.warnings??Z,i.failure&&Me(!1),i.failure&&(d.get().isReady?je(i.failure):n.reject(new Error(i.failure))),d.get().isReady?Ee():No(c("message-text"),c("run-stage").textContent)},l=async(i,{bytes:h=null,isFinished:u})=>{let f=performance.now(),p=await e({entry:t,bytes:i,size:h,notes:[]}).catch(w=>{o?n.reject(w):je(w.message)});if(!p)return Me(!u&&$),{took:performance.now()-f,isSlow:$};let m=performance.now()-f;o&&n.resolve(p),o=!1,await la.promise,v.model()!==p&&_o(p,u);let x=Ao();return Me(!u&&Math.min(x,r)>Ut),r=x,{took:m+x,isSlow:$}};return Me(!0),It({tell:s,canShow:()=>o||d.get().isReady,show:l,others:a}).catch(n.reject),n.promise}function _o(t,e){let a=v;v=new K([t]),g.setLevels(v),t.setParallax(d.get().parallax),c("parallax-switch").hidden=!U().some(n=>n.parallax.length),d.get().mode==="uv"?fa():Ye=!1,ha.push(...a.models),e&&(J.setModels(U()),ma()),Ee(),y()}function No(t,e){t.textContent!==e&&(t.textContent=e)}var U=()=>[...v.models,S].filter(Boolean);function Ee(){let t=[...new Set([...U().flatMap(e=>e.notes),...Z])];t.join(`
`)!==ra&&(ra=t.join(`
`),_t(t))}function $o(){J=ea(y),J.setModels(U());let t=Rt.filter(([e])=>S||!kt(e));Y(c("modes"),"mode",t,e=>d.set({mode:e})),c("modes").disabled=!1,aa(d),ma(),d.on(["level"],({level:e})=>N(c("levels"),e)),Eo(),Ro(),Po(t.map(([e])=>e)),c("parallax-switch").hidden=!U().some(e=>e.parallax.length),d.on(["parallax"],({parallax:e})=>{for(let a of U())a.setParallax(e)}),d.set({isReady:!0,hasCompare:S!==null,mode:S?"split":"model"}),d.on(["mode","hasCompare"],({mode:e,hasCompare:a})=>{c("legend").hidden=e!=="difference",(!a||e==="uv")&&(c("reading").hidden=!0),e==="uv"&&!Ye&&fa(),N(c("modes"),e)}),d.on(So,y),la.resolve()}async function Uo(){Ot(d),na(d),c("legend-ramp").style.background=`linear-gradient(90deg, ${O.join(", ")})`,c("legend-most").textContent=`${Math.round(Re*255)} of 255 and more`,c("banner-close").addEventListener("click",()=>{c("banner").hidden=!0}),c("canvas").addEventListener("webglcontextlost",()=>{da(new Error("The graphics processor has dropped this page, most likely for want of memory. Reload the page."))});let t=setTimeout(()=>{c("message-text").textContent+=". Large models take a while."},bo),e=await Oo(await ko());clearTimeout(t),$o(),e&&je(`The model is shown by itself: ${e}`),e&&(Z=[...Z,e]),Ee(),Te(),c("message").hidden=!0,U().some(a=>a.hasExtensions)&&requestAnimationFrame(()=>setTimeout(()=>d.set({light:"room"}))),setTimeout(Ee,1e3),window.parbake={store:d,stage:g,redraw:y,settled:Mo,snapshot:()=>(Te(),c("canvas").toDataURL())}}Uo().catch(da);
