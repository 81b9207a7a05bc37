// tornado.vol, translated by vol 0.1.0
// The scene at 0 s with the params it was translated with.
// To be called:
//   distance(p: vec3f) -> f32: Bound on the distance to the nearest object, negative inside, scene units.
//   density(p: vec3f) -> f32: Sum of the densities of all media.
//   radiance(origin: vec3f, direction: vec3f) -> vec4f: Scene-linear radiance along a ray from the camera or another place outside the objects, and what it hides of what is behind.
//   pixel(place: vec2f) -> vec4f: The same through a place of the picture, in pixels from its upper left corner.
//   distance_cloud(p: vec3f) -> f32: The field `distance:cloud` of the scene.
//   density_cloud(p: vec3f) -> f32: The field `density:cloud` of the scene.
//   colour_cloud(p: vec3f) -> vec3f: The field `colour:cloud` of the scene.
//   local_cloud(p: vec3f) -> vec3f: The field `local:cloud` of the scene.



struct Vol_Cell {
    ivec3 corner;
    vec3 place;
    vec3 fade;
};
struct Vol_Blend {
    float value;
    vec3 gradient;
    vec3 slope;
};
struct Vol_CurvePoint {
    float t;
    float arc_length;
    float curve_length;
    float x;
    float y;
    float distance_;
    float overshoot;
    float stretch;
};
struct Vol_Foot {
    float t;
    float dist_sq;
};
struct Vol_Inner {
    float t;
    float dist_sq;
    bool start_is_least;
    float start_sq;
    bool dips;
};
struct Vol_Search {
    float dist_sq;
    float t;
    uint piece;
    bool left_at_last;
};
struct Vol_CurveSlopes {
    vec3 direction;
    vec3 tangent;
    float rate;
    float slide;
};
struct Vol_Curve {
    uint first;
    uint count;
    uint number;
};
struct Vol_LastSearch {
    bool some;
    vec3 point;
    Vol_Search found;
    float reach;
};
struct Vol_Out10_ {
    float v0_;
    float v1_;
    float v2_;
    float v3_;
    float v4_;
    float v5_;
    float v6_;
    float v7_;
    float v8_;
    float v9_;
};
struct Vol_in_Response {
    vec3 emitted;
    vec3 diffuse;
    vec3 specular;
    float shininess;
};
struct Vol_in_Interior {
    float density;
    vec3 scattering;
    vec3 extinction;
    vec3 emission;
};
struct Vol_in_Mean {
    uint count;
    vec3 color;
    vec3 transmittance;
    float depth;
    float color_spread;
    float transmittance_spread;
    float doubt;
};
struct Vol_in_Ray {
    vec3 origin;
    vec3 direction;
    float shift;
};
struct Vol_in_Radiance {
    vec3 color;
    vec3 transmittance;
    float depth;
    float doubt;
};
struct Vol_in_Contact {
    bool hit;
    uint solid;
    float t;
    vec3 position;
    vec3 normal;
    float residual;
};
struct Vol_in_Span {
    float entry;
    float leave;
};
struct Vol_in_Walker {
    float t;
    float before;
    float free;
    bool guessed;
};
struct Vol_in_Near {
    float distance_;
    float value;
    uint solid;
    float gap;
    float rest;
    float entry;
    float leave;
};
struct Vol_in_Bracket {
    vec2 outside;
    vec2 inside;
};
struct Vol_in_Arriving {
    vec3 direction;
    float distance_;
    vec3 irradiance;
    bool shadows;
    float slope;
    uint grid;
    uint style;
};
struct Vol_in_Around {
    float distance_;
    float safe;
    float gap;
};
struct Vol_in_Stencil {
    ivec4 at;
    vec4 weights;
};
struct Vol_in_Runs {
    vec4 first;
    vec4 last;
};
struct Vol_in_Comb {
    float step_;
    float offset;
    int block;
    float end;
    int first;
    int last;
    Vol_in_Runs all_[1];
    ivec2 runs[1];
    float before[1];
    int steps_before;
    float own[1];
};
struct Vol_in_Node {
    int first;
    int steps;
    int number;
};
struct Vol_in_Glow {
    vec3 light;
    vec3 transmittance;
    vec3 coarse_light;
    vec3 coarse_transmittance;
};
struct Vol_in_StyledRays {
    float none;
};
struct Vol_in_Chunk {
    vec3 sent;
    vec3 depth;
};
const vec4 vol_uniforms[7] = vec4[7](vec4(0.0, 0.0033465358, 0.0051815165, 0.014443844), vec4(10.0, 30.0, 1.0, 1.1), vec4(4.5, 0.6981317, 0.0, 0.4), vec4(0.2, 2.2, 1.5609045, 0.69090724), vec4(1000000000000000.0, 0.6, 0.5264106, 0.79870445), vec4(1.1264106, 5.0, 0.0, 0.0), vec4(-0.4, 0.8, 0.3, 12.0));
const vec4 vol_curves[45] = vec4[45](vec4(0.2, 1.1, 0.1, -2.9802323e-9), vec4(-2.3841858e-8, -1.4901161e-9, 0.0, -0.55), vec4(0.0, -0.2, 0.0, -0.1), vec4(0.0, 1.0, 0.0, -0.029880034), vec4(0.0, 0.9995535, 0.9995535, 0.0), vec4(0.029880034, 0.055, 0.0, -0.11), vec4(0.05, 0.0, 0.3025, 0.0), vec4(20.0, 0.5, -0.5, 1.1295928), vec4(-1.0, 0.2236068, 1.3528211, 0.12298374), vec4(0.0, 0.0, 1.0, 2.2591856), vec4(0.0, 0.0, 0.0, 0.0), vec4(0.0, 0.0, 0.33686078, 0.9263671), vec4(0.16843039, -0.33686078, 0.9263671, -0.16843039), vec4(-4.5778493e-6, -4.598711e-6, -4.576359e-6, 0.20000459), vec4(1.1000047, 0.10000458, 0.0, 0.0), vec4(0.2, 1.1, 0.1, -2.9802323e-9), vec4(-2.3841858e-8, -1.4901161e-9, 0.0, 0.55), vec4(0.0, -0.2, 0.0, -0.1), vec4(0.0, 1.0, 0.0, -0.029880034), vec4(0.0, 0.9995535, 0.9995535, 0.0), vec4(0.029880034, -0.055, 0.0, 0.11), vec4(0.05, 0.0, 0.3025, 0.0), vec4(20.0, 0.5, 0.5, 1.1295928), vec4(1.0, 0.2236068, 1.3528211, 0.12298374), vec4(0.0, 1.0, 0.0, 2.2591856), vec4(0.0, 2.2, 0.0, 0.0), vec4(-4.7683717e-8, 0.0, -0.33686078, 0.9263671), vec4(-0.16843039, 0.0, 1.0, 0.0), vec4(-4.5778493e-6, 1.0999953, -4.576359e-6, 0.20000459), vec4(2.2000048, 0.10000458, 0.0, 0.0), vec4(0.0, 0.0, 0.0, 0.0), vec4(0.0, 0.0, 0.0, 0.0), vec4(0.0, 0.0, 0.0, 0.0), vec4(0.0, 0.0, 0.0, 0.0), vec4(0.0, 0.0, 0.0, 0.0), vec4(0.0, 0.0, 0.0, 0.0), vec4(0.0, 0.0, 0.0, 0.0), vec4(0.0, 0.0, 0.0, 0.0), vec4(0.0, 0.0, 0.0, 0.0), vec4(0.0, 0.0, 0.0, 0.0), vec4(0.0, 0.0, 0.0, 0.0), vec4(0.0, 0.0, 0.0, 0.0), vec4(0.0, 0.0, 0.0, 0.0), vec4(0.0, 0.0, 0.0, 0.0), vec4(0.0, 0.0, 0.0, 0.0));
const uvec4 vol_permutation[64] = uvec4[64](uvec4(151u, 160u, 137u, 91u), uvec4(90u, 15u, 131u, 13u), uvec4(201u, 95u, 96u, 53u), uvec4(194u, 233u, 7u, 225u), uvec4(140u, 36u, 103u, 30u), uvec4(69u, 142u, 8u, 99u), uvec4(37u, 240u, 21u, 10u), uvec4(23u, 190u, 6u, 148u), uvec4(247u, 120u, 234u, 75u), uvec4(0u, 26u, 197u, 62u), uvec4(94u, 252u, 219u, 203u), uvec4(117u, 35u, 11u, 32u), uvec4(57u, 177u, 33u, 88u), uvec4(237u, 149u, 56u, 87u), uvec4(174u, 20u, 125u, 136u), uvec4(171u, 168u, 68u, 175u), uvec4(74u, 165u, 71u, 134u), uvec4(139u, 48u, 27u, 166u), uvec4(77u, 146u, 158u, 231u), uvec4(83u, 111u, 229u, 122u), uvec4(60u, 211u, 133u, 230u), uvec4(220u, 105u, 92u, 41u), uvec4(55u, 46u, 245u, 40u), uvec4(244u, 102u, 143u, 54u), uvec4(65u, 25u, 63u, 161u), uvec4(1u, 216u, 80u, 73u), uvec4(209u, 76u, 132u, 187u), uvec4(208u, 89u, 18u, 169u), uvec4(200u, 196u, 135u, 130u), uvec4(116u, 188u, 159u, 86u), uvec4(164u, 100u, 109u, 198u), uvec4(173u, 186u, 3u, 64u), uvec4(52u, 217u, 226u, 250u), uvec4(124u, 123u, 5u, 202u), uvec4(38u, 147u, 118u, 126u), uvec4(255u, 82u, 85u, 212u), uvec4(207u, 206u, 59u, 227u), uvec4(47u, 16u, 58u, 17u), uvec4(182u, 189u, 28u, 42u), uvec4(223u, 183u, 170u, 213u), uvec4(119u, 248u, 152u, 2u), uvec4(44u, 154u, 163u, 70u), uvec4(221u, 153u, 101u, 155u), uvec4(167u, 43u, 172u, 9u), uvec4(129u, 22u, 39u, 253u), uvec4(19u, 98u, 108u, 110u), uvec4(79u, 113u, 224u, 232u), uvec4(178u, 185u, 112u, 104u), uvec4(218u, 246u, 97u, 228u), uvec4(251u, 34u, 242u, 193u), uvec4(238u, 210u, 144u, 12u), uvec4(191u, 179u, 162u, 241u), uvec4(81u, 51u, 145u, 235u), uvec4(249u, 14u, 239u, 107u), uvec4(49u, 192u, 214u, 31u), uvec4(181u, 199u, 106u, 157u), uvec4(184u, 84u, 204u, 176u), uvec4(115u, 121u, 50u, 45u), uvec4(127u, 4u, 150u, 254u), uvec4(138u, 236u, 205u, 93u), uvec4(222u, 114u, 67u, 29u), uvec4(24u, 72u, 243u, 141u), uvec4(128u, 195u, 78u, 66u), uvec4(215u, 61u, 156u, 180u));
const vec4 vol_frame[43] = vec4[43](vec4(0.0, 0.0, 960.0, 540.0), vec4(960.0, 540.0, 0.004680485, 0.00936097), vec4(0.0, 1.1, 4.5, 0.0), vec4(0.0, -1.0, 0.6470582, 0.0), vec4(0.0, 0.0, 0.36397022, 0.0), vec4(0.0033465358, 0.0051815165, 0.014443844, 1.0), vec4(1.0, 0.0, 1.0, 3.0), vec4(-0.60002863, -0.60002863, -0.60002863, 1.000029), vec4(2.8000307, 0.8000288, 16.0, 1.0), vec4(1.0, -0.42399916, 0.8479983, 0.31799936), vec4(12.0, 12.0, 12.0, 1.0), vec4(0.0, 0.0, 0.0, 0.0), vec4(0.0, 0.0, 0.0, 0.0), vec4(0.0, 0.0, 0.0, 0.0), vec4(0.0, 0.0, 0.0, 0.0), vec4(0.0, 0.0, 0.0, 0.0), vec4(0.0, 0.0, 0.0, 0.0), vec4(0.0, 0.0, 0.0, 0.0), vec4(0.0, 0.0, 0.0, 0.0), vec4(-0.07849332, -0.03100111, -0.08124195, 0.12536836), vec4(0.16850124, 0.10467947, -0.038403668, 0.107851274), vec4(-0.064069755, 0.1727788, 0.3046489, 0.13125731), vec4(-0.008553555, 0.24621235, -0.05407174, 0.21792875), vec4(0.44128785, 0.15875934, 0.010998466, 0.3846571), vec4(-0.051262047, 0.26087677, 0.57784307, 0.18719967), vec4(0.020236308, 0.52379215, -0.05564443, 0.30163896), vec4(0.71370804, 0.21658209, 0.019191828, 0.6642433), vec4(-0.067210674, 0.3401835, 0.84825695, 0.24689835), vec4(0.007948153, 0.8066414, -0.08580606, 0.3764272), vec4(0.98085874, 0.27799374, -0.0131498, 0.9516064), vec4(-0.1115874, 0.41002518, 1.1108938, 0.3100251), vec4(-0.04768115, 1.087319, -0.14611875, 0.44455653), vec4(1.2501811, 0.34455645, -0.0956435, 1.2085621), vec4(-0.1894001, 0.48001888, 1.403938, 0.3815878), vec4(-0.15293887, 1.3255475, -0.23986568, 0.5123142), vec4(1.5619527, 0.41955334, -0.21955688, 1.4378978), vec4(-0.29706544, 0.5414322, 1.7246025, 0.4580031), vec4(-0.29523104, 1.5453081, -0.36114627, 0.5671063), vec4(1.8921922, 0.4970839, -0.37969407, 1.6475452), vec4(-0.43204588, 0.5890693, 2.0649552, 0.53673345), vec4(-0.47268757, 1.7444439, -0.5097059, 0.6070627), vec4(2.2430565, 0.57689345, -0.5739689, 1.8359008), vec4(-0.5940731, 0.62084395, 2.4265997, 0.6175107));
const vec4 vol_input[1] = vec4[1](vec4(0.0, 0.0, 0.0, 0.0));
const uint VOL_CURVES = 1u;
const float VOL_SMALLEST = 1.1754944e-38;
const float VOL_LARGEST = 3.4028235e38;
const float VOL_TURNS_PER_RADIAN = 0.15915494;
const float VOL_PI = 3.1415927;
const float VOL_HALF_PI = 1.5707964;
const float VOL_LOG2_E = 1.442695;
const float VOL_LN_2_ = 0.6931472;
const float VOL_FIELD = 4194303.0;
const float VOL_WHOLES = 16777216.0;
const float VOL_PRODUCT = 1099511600000.0;
const float VOL_OCTAVES = 32.0;
const uint VOL_PIECE_WORDS = 60u;
const float VOL_TINY = 1e-30;
const float VOL_FAR = 1e18;
const float VOL_REACH = 100000000.0;
const float VOL_STRETCH = 1000000.0;
const float VOL_LOOSE = 1.00001;
const float VOL_SLACK = 4e-6;
const float VOL_LEAN = 0.001;
const float VOL_LEAST_STRETCH = 0.05;
const float VOL_LARGEST_RATE = 1000000000000000.0;
const uint VOL_IN_AT_TILE = 0u;
const uint VOL_IN_AT_SIZE = 4u;
const uint VOL_IN_AT_STEP = 6u;
const uint VOL_IN_AT_SHADOW_STEP = 7u;
const uint VOL_IN_AT_EYE = 8u;
const uint VOL_IN_AT_FORWARD = 11u;
const uint VOL_IN_AT_RIGHT = 14u;
const uint VOL_IN_AT_UP = 17u;
const uint VOL_IN_AT_BACKGROUND = 20u;
const uint VOL_IN_AT_LIGHT_COUNT = 23u;
const uint VOL_IN_AT_SAMPLES = 24u;
const uint VOL_IN_AT_TOLERANCE = 25u;
const uint VOL_IN_AT_BUDGET = 26u;
const uint VOL_IN_OBJECT_COUNT = 0u;
const uint VOL_IN_MEDIUM_COUNT = 1u;
const uint VOL_IN_OBJECT_SLOTS = 1u;
const uint VOL_IN_MEDIUM_SLOTS = 1u;
const uint VOL_IN_LIGHT_SLOTS = 1u;
const uint VOL_IN_TRANSFER_SIZE = 256u;
const uint VOL_IN_OBJECT_WORDS = 8u;
const uint VOL_IN_MEDIUM_WORDS = 9u;
const uint VOL_IN_CELL_WORDS = 6u;
const uint VOL_IN_CELLS_WORDS = 384u;
const uint VOL_IN_LIGHT_WORDS = 12u;
const uint VOL_IN_PIXEL_WORDS = 15u;
const uint VOL_IN_AT_OBJECTS = 27u;
const uint VOL_IN_AT_MEDIA = 27u;
const uint VOL_IN_AT_LIGHTS = 36u;
const uint VOL_IN_AT_CELLS = 76u;
const uint VOL_IN_ROW_WORDS = 0u;
const bool VOL_IN_CORRECTED = false;
const bool VOL_IN_SPACED = false;
const bool VOL_IN_SOFT_LIGHTS = false;
const bool VOL_IN_OCCLUDING_LIGHTS = false;
const bool VOL_IN_LIGHT_GRIDS = true;
const bool VOL_IN_LIT_MEDIA = true;
const bool VOL_IN_STYLES = false;
const bool VOL_IN_MARCHED_SHAFTS = false;
const float VOL_IN_FAR = 4000000.0;
const float VOL_IN_PARALLEL = 1e-12;
const float VOL_IN_EPSILON = 1.1920929e-7;
const float VOL_IN_FLAT = 1e-15;
const float VOL_IN_OPAQUE = 24.0;
const float VOL_IN_STOP = 1.5258789e-5;
const float VOL_IN_NO_DEPTH = 1e30;
const float VOL_IN_MAX_SPREAD_TANGENT = 1.7320508;
const uint VOL_IN_MAX_STEPS = 2000u;
const uint VOL_IN_REFINEMENTS = 4u;
const float VOL_IN_EAGERNESS = 1.95;
const float VOL_IN_ROOM = 0.98;
const int VOL_IN_MAX_NODES = 16384;
const float VOL_IN_LAST_NODE = 4194304.0;
const float VOL_IN_SHOWS_NORMALS = 2.0;
const float VOL_IN_BY_STEEPNESS = 0.0;
const float VOL_IN_NO_BOUND = 1e30;
const uint VOL_IN_TRIES = 8u;
const float VOL_IN_UNLIT = 1.0;
const float VOL_IN_UNSHADOWED = 2.0;
const float VOL_IN_SHADOWED = 3.0;
const uint VOL_IN_NO_CORNER = 4u;
const float VOL_IN_ROOT_THIRD = 0.5773503;
const uint VOL_IN_FIRST_ROUND = 9u;
const uint VOL_IN_ROUND = 8u;
const float VOL_IN_LEAST_BRIGHTNESS = 0.0625;
const vec2 VOL_IN_RIM[8] = vec2[8](vec2(1.0, 0.0), vec2(0.70710677, 0.70710677), vec2(0.0, 1.0), vec2(-0.70710677, 0.70710677), vec2(-1.0, 0.0), vec2(-0.70710677, -0.70710677), vec2(0.0, -1.0), vec2(0.70710677, -0.70710677));
const uint VOL_IN_RIM_COUNT = 8u;
const float VOL_IN_CLEAR = 2.0;
const vec2 VOL_IN_PLACES[19] = vec2[19](vec2(0.0, 0.0), vec2(0.4, 0.0), vec2(0.2, 0.3464102), vec2(-0.2, 0.3464102), vec2(-0.4, 0.0), vec2(-0.2, -0.3464102), vec2(0.2, -0.3464102), vec2(0.7727407, 0.2070552), vec2(0.5656854, 0.5656854), vec2(0.2070552, 0.7727407), vec2(-0.2070552, 0.7727407), vec2(-0.5656854, 0.5656854), vec2(-0.7727407, 0.2070552), vec2(-0.7727407, -0.2070552), vec2(-0.5656854, -0.5656854), vec2(-0.2070552, -0.7727407), vec2(0.2070552, -0.7727407), vec2(0.5656854, -0.5656854), vec2(0.7727407, -0.2070552));
const uint VOL_IN_PLACE_COUNT = 19u;
const float VOL_IN_LACK = 0.05;
const float VOL_IN_BLUR = 0.3;
const int VOL_IN_NO_NODE = 8388608;
const float VOL_IN_NO_RUN = 8388608.0;
const float VOL_IN_WEIGHTS[5] = float[5](16.0, 8.0, 4.0, 2.0, 1.0);
const uint VOL_IN_WEIGHT_COUNT = 5u;
const float VOL_IN_WEIGHT_SUM = 31.0;
const uvec2 VOL_IN_STRIDE = uvec2(3242174889u, 2447445414u);
const uint VOL_IN_GOLDEN_STRIDE = 2654435769u;

Vol_LastSearch vol_last_search[1] = Vol_LastSearch[1](Vol_LastSearch(false, vec3(0.0), Vol_Search(0.0, 0.0, 0u, false), 0.0));


float vol_uniform_word(uint index) {
    return vol_uniforms[(index >> 2u)][(index & 3u)];
}

float vol_curve_word(uint index_1) {
    return vol_curves[(index_1 >> 2u)][(index_1 & 3u)];
}

uint vol_permutation_word(uint index_2) {
    return vol_permutation[(index_2 >> 2u)][(index_2 & 3u)];
}

float vol_frame_word(uint index_3) {
    return vol_frame[(index_3 >> 2u)][(index_3 & 3u)];
}

float vol_input_word(uint index_4) {
    return vol_input[(index_4 >> 2u)][(index_4 & 3u)];
}

float vol_hold(float x, float low, float high) {
    return min(max(x, low), high);
}

float vol_round(float x_1) {
    return floor((x_1 + 0.5));
}

float vol_exp2_(float x_2) {
    float _e3 = vol_hold(x_2, -126.0, 127.0);
    float _e4 = vol_round(_e3);
    float f = (_e3 - _e4);
    float p5_ = (0.0013398875 + (f * 0.0001535336));
    float p4_ = (0.009618437 + (f * p5_));
    float p3_ = (0.055503324 + (f * p4_));
    float p2_ = (0.24022648 + (f * p3_));
    float p1_ = (0.6931472 + (f * p2_));
    float power = (1.0 + (f * p1_));
    uint exponent = uint((int(_e4) << 23u));
    float scaled = uintBitsToFloat((floatBitsToUint(power) + exponent));
    return ((x_2 < -126.0) ? 0.0 : scaled);
}

float vol_log2_(float x_3) {
    float _e3 = vol_hold(x_3, VOL_SMALLEST, VOL_LARGEST);
    int bits = floatBitsToInt(_e3);
    int e = ((bits - 1060439283) >> 23u);
    float m_1 = intBitsToFloat((bits - (e << 23u)));
    float f_1 = (m_1 - 1.0);
    float p7_ = (-0.11675641 + (f_1 * 0.06746601));
    float p6_ = (0.11888175 + (f_1 * p7_));
    float p5_1 = (-0.124055915 + (f_1 * p6_));
    float p4_1 = (0.14219551 + (f_1 * p5_1));
    float p3_1 = (-0.16667996 + (f_1 * p4_1));
    float p2_1 = (0.20002119 + (f_1 * p3_1));
    float p1_1 = (-0.2500001 + (f_1 * p2_1));
    float p0_ = (0.33333313 + (f_1 * p1_1));
    float ff = (f_1 * f_1);
    float ln = (f_1 + (ff * ((f_1 * p0_) - 0.5)));
    return (float(e) + (ln * VOL_LOG2_E));
}

vec3 vol_quarter_turn(float x_4) {
    float u_1 = (x_4 * VOL_TURNS_PER_RADIAN);
    float _e3 = vol_round(u_1);
    float t_33 = (u_1 - _e3);
    float _e7 = vol_round((t_33 * 4.0));
    float r = (t_33 - (_e7 * 0.25));
    float s = (r * r);
    float a3_1 = (-76.69787 + (s * 41.472946));
    float a2_ = (81.6052 + (s * a3_1));
    float a1_1 = (-41.3417 + (s * a2_));
    float a0_1 = (6.2831855 + (s * a1_1));
    float b3_ = (-85.442856 + (s * 59.220406));
    float b2_2 = (64.939316 + (s * b3_));
    float b1_2 = (-19.73921 + (s * b2_2));
    float b0_ = (1.0 + (s * b1_2));
    return vec3((r * a0_1), b0_, _e7);
}

float vol_sin(float x_5) {
    vec3 _e1 = vol_quarter_turn(x_5);
    int k_6 = int(_e1.z);
    float size = (((k_6 & 1) != 0) ? _e1.y : _e1.x);
    return (((k_6 & 2) != 0) ? -(size) : size);
}

float vol_cos(float x_6) {
    vec3 _e1 = vol_quarter_turn(x_6);
    int k_7 = int(_e1.z);
    float size_1 = (((k_7 & 1) != 0) ? _e1.x : _e1.y);
    return ((((k_7 + 1) & 2) != 0) ? -(size_1) : size_1);
}

float vol_atan2_(float y, float x_7) {
    float ax = abs(x_7);
    float ay = abs(y);
    float q = (min(ax, ay) / max(max(ax, ay), VOL_SMALLEST));
    float s_1 = (q * q);
    float p7_1 = (-0.01606848 + (s_1 * 0.002849852));
    float p6_1 = (0.042691275 + (s_1 * p7_1));
    float p5_2 = (-0.07504274 + (s_1 * p6_1));
    float p4_2 = (0.106409244 + (s_1 * p5_2));
    float p3_2 = (-0.14203642 + (s_1 * p4_2));
    float p2_2 = (0.1999262 + (s_1 * p3_2));
    float p1_2 = (-0.33333072 + (s_1 * p2_2));
    float p0_1 = (1.0 + (s_1 * p1_2));
    float base = (q * p0_1);
    float half_ = ((ay > ax) ? (VOL_HALF_PI - base) : base);
    float full = ((x_7 < 0.0) ? (VOL_PI - half_) : half_);
    return ((y < 0.0) ? -(full) : full);
}

float vol_acos(float x_8) {
    float a_7 = min(abs(x_8), 1.0);
    float p6_2 = (0.006671244 + (a_7 * -0.0012628166));
    float p5_3 = (-0.017089743 + (a_7 * p6_2));
    float p4_3 = (0.030893007 + (a_7 * p5_3));
    float p3_3 = (-0.0501747 + (a_7 * p4_3));
    float p2_3 = (0.08897905 + (a_7 * p3_3));
    float p1_3 = (-0.2145988 + (a_7 * p2_3));
    float p0_2 = (1.5707963 + (a_7 * p1_3));
    float angle = (sqrt((1.0 - a_7)) * p0_2);
    return ((x_8 < 0.0) ? (VOL_PI - angle) : angle);
}

float vol_fade(float t) {
    float s_2 = (t - 0.5);
    float ss = (s_2 * s_2);
    return (0.5 + (s_2 * (1.875 - (ss * (5.0 - (6.0 * ss))))));
}

Vol_Cell vol_cell_of(vec3 p) {
    float _e4 = vol_hold(p.x, -4194303.0, VOL_FIELD);
    float _e8 = vol_hold(p.y, -4194303.0, VOL_FIELD);
    float _e12 = vol_hold(p.z, -4194303.0, VOL_FIELD);
    vec3 held = vec3(_e4, _e8, _e12);
    vec3 whole = floor(held);
    vec3 place_5 = (held - whole);
    float _e17 = vol_fade(place_5.x);
    float _e19 = vol_fade(place_5.y);
    float _e21 = vol_fade(place_5.z);
    vec3 weights_3 = vec3(_e17, _e19, _e21);
    return Vol_Cell(ivec3(whole), place_5, weights_3);
}

float vol_fade_slope(float t_1) {
    float s_3 = (t_1 - 0.5);
    float ss_1 = (s_3 * s_3);
    return (1.875 - (ss_1 * (15.0 - (30.0 * ss_1))));
}

float vol_lerp(float t_2, float a, float b) {
    return (a + (t_2 * (b - a)));
}

vec3 vol_lerp3_(float t_3, vec3 a_1, vec3 b_1) {
    return (a_1 + (t_3 * (b_1 - a_1)));
}

float vol_edge_value(uint code, float x_9, float y_1, float z) {
    float u_2 = ((code < 8u) ? x_9 : y_1);
    float v_3 = ((code < 4u) ? y_1 : (((code & 13u) == 12u) ? x_9 : z));
    float signed_u = (((code & 1u) != 0u) ? -(u_2) : u_2);
    float signed_v = (((code & 2u) != 0u) ? -(v_3) : v_3);
    return (signed_u + signed_v);
}

vec3 vol_edge_vector(uint code_1) {
    float signed_u_1 = (((code_1 & 1u) != 0u) ? -1.0 : 1.0);
    float signed_v_1 = (((code_1 & 2u) != 0u) ? -1.0 : 1.0);
    bool wraps = ((code_1 & 13u) == 12u);
    float x_23 = ((code_1 < 8u) ? signed_u_1 : (wraps ? signed_v_1 : 0.0));
    float y_8 = ((code_1 < 4u) ? signed_v_1 : ((code_1 < 8u) ? 0.0 : signed_u_1));
    float z_6 = (((code_1 < 4u) || wraps) ? 0.0 : signed_v_1);
    return vec3(x_23, y_8, z_6);
}

int vol_permuted(int i) {
    uint _e4 = vol_permutation_word(uint((i & 255)));
    return int(_e4);
}

uint vol_table_cell(int x_10, int y_2, int z_1) {
    int _e3 = vol_permuted(x_10);
    int _e5 = vol_permuted((_e3 + y_2));
    int _e7 = vol_permuted((_e5 + z_1));
    return (uint(_e7) & 15u);
}

uint vol_mixed(uint joined) {
    uint first_2 = ((joined ^ (joined >> 16u)) * 2146121005u);
    return ((first_2 ^ (first_2 >> 15u)) * 2221713035u);
}

uint vol_spread(int x_11, int y_3, int z_2, uint seed) {
    uint spread_xy = ((uint(x_11) * 2376512323u) ^ (uint(y_3) * 3625334849u));
    uint spread_zs = ((uint(z_2) * 3407524639u) ^ (seed * 2654435761u));
    return (spread_xy ^ spread_zs);
}

uint vol_hash_cell(int x_12, int y_4, int z_3, uint seed_1) {
    uint _e4 = vol_spread(x_12, y_4, z_3, seed_1);
    uint _e5 = vol_mixed(_e4);
    return (_e5 >> 28u);
}

uint vol_hash_word(int x_13, int y_5, int z_4, int w, uint seed_2) {
    uint fourth = ((uint(w) * 3266489909u) ^ 668265263u);
    uint _e10 = vol_spread(x_13, y_5, z_4, seed_2);
    uint _e12 = vol_mixed((_e10 ^ fourth));
    return (_e12 ^ (_e12 >> 16u));
}

float vol_unit_number(uint word) {
    return (float((word >> 8u)) * 5.9604645e-8);
}

vec3 vol_unit_point(uint word_1) {
    uvec3 bits_1 = (uvec3(word_1, (word_1 >> 10u), (word_1 >> 20u)) & uvec3(1023u));
    return ((vec3(bits_1) + vec3(0.5)) * 0.0009765625);
}

float vol_hash(vec4 p_1, uint seed_3) {
    float _e5 = vol_hold(p_1.x, -16777216.0, VOL_WHOLES);
    int x_24 = int(floor(_e5));
    float _e11 = vol_hold(p_1.y, -16777216.0, VOL_WHOLES);
    int y_9 = int(floor(_e11));
    float _e17 = vol_hold(p_1.z, -16777216.0, VOL_WHOLES);
    int z_7 = int(floor(_e17));
    float _e23 = vol_hold(p_1.w, -16777216.0, VOL_WHOLES);
    int w_2 = int(floor(_e23));
    uint _e26 = vol_hash_word(x_24, y_9, z_7, w_2, seed_3);
    float _e27 = vol_unit_number(_e26);
    return _e27;
}

uint vol_corner_code(Vol_Cell c, int i_1, int j, int k, uint seed_4) {
    int x_25 = (c.corner.x + i_1);
    int y_10 = (c.corner.y + j);
    int z_8 = (c.corner.z + k);
    uint _e14 = vol_hash_cell(x_25, y_10, z_8, seed_4);
    uint _e15 = vol_table_cell(x_25, y_10, z_8);
    return ((seed_4 == 0u) ? _e15 : _e14);
}

float vol_corner(Vol_Cell c_1, int i_2, int j_1, int k_1, uint seed_5) {
    uint _e5 = vol_corner_code(c_1, i_2, j_1, k_1, seed_5);
    float _e18 = vol_edge_value(_e5, (c_1.place.x - float(i_2)), (c_1.place.y - float(j_1)), (c_1.place.z - float(k_1)));
    return _e18;
}

float vol_perlin(vec3 p_2, uint seed_6) {
    Vol_Cell _e2 = vol_cell_of(p_2);
    float u_3 = _e2.fade.x;
    float v_4 = _e2.fade.y;
    float w_3 = _e2.fade.z;
    float _e12 = vol_corner(_e2, 0, 0, 0, seed_6);
    float _e16 = vol_corner(_e2, 1, 0, 0, seed_6);
    float _e17 = vol_lerp(u_3, _e12, _e16);
    float _e21 = vol_corner(_e2, 0, 1, 0, seed_6);
    float _e25 = vol_corner(_e2, 1, 1, 0, seed_6);
    float _e26 = vol_lerp(u_3, _e21, _e25);
    float _e30 = vol_corner(_e2, 0, 0, 1, seed_6);
    float _e34 = vol_corner(_e2, 1, 0, 1, seed_6);
    float _e35 = vol_lerp(u_3, _e30, _e34);
    float _e39 = vol_corner(_e2, 0, 1, 1, seed_6);
    float _e43 = vol_corner(_e2, 1, 1, 1, seed_6);
    float _e44 = vol_lerp(u_3, _e39, _e43);
    float _e45 = vol_lerp(v_4, _e17, _e26);
    float _e46 = vol_lerp(v_4, _e35, _e44);
    float _e47 = vol_lerp(w_3, _e45, _e46);
    return _e47;
}

Vol_Blend vol_corner_blend(Vol_Cell c_2, int i_3, int j_2, int k_2, uint seed_7) {
    uint _e5 = vol_corner_code(c_2, i_3, j_2, k_2, seed_7);
    float _e18 = vol_edge_value(_e5, (c_2.place.x - float(i_3)), (c_2.place.y - float(j_2)), (c_2.place.z - float(k_2)));
    vec3 _e19 = vol_edge_vector(_e5);
    return Vol_Blend(_e18, _e19, vec3(0.0, 0.0, 0.0));
}

Vol_Blend vol_blend(bvec3 axis, float t_4, Vol_Blend a_2, Vol_Blend b_2) {
    float rise = (b_2.value - a_2.value);
    vec3 _e9 = vol_lerp3_(t_4, a_2.slope, b_2.slope);
    vec3 slope_7 = mix(_e9, vec3(rise, rise, rise), axis);
    vec3 _e17 = vol_lerp3_(t_4, a_2.gradient, b_2.gradient);
    return Vol_Blend((a_2.value + (t_4 * rise)), _e17, slope_7);
}

vec4 vol_perlin_gradient(vec3 p_3, uint seed_8) {
    Vol_Cell _e2 = vol_cell_of(p_3);
    float u_4 = _e2.fade.x;
    float v_5 = _e2.fade.y;
    float w_4 = _e2.fade.z;
    bvec3 along_x = bvec3(true, false, false);
    bvec3 along_y = bvec3(false, true, false);
    bvec3 along_z = bvec3(false, false, true);
    Vol_Blend _e24 = vol_corner_blend(_e2, 0, 0, 0, seed_8);
    Vol_Blend _e28 = vol_corner_blend(_e2, 1, 0, 0, seed_8);
    Vol_Blend _e32 = vol_corner_blend(_e2, 0, 1, 0, seed_8);
    Vol_Blend _e36 = vol_corner_blend(_e2, 1, 1, 0, seed_8);
    Vol_Blend _e40 = vol_corner_blend(_e2, 0, 0, 1, seed_8);
    Vol_Blend _e44 = vol_corner_blend(_e2, 1, 0, 1, seed_8);
    Vol_Blend _e48 = vol_corner_blend(_e2, 0, 1, 1, seed_8);
    Vol_Blend _e52 = vol_corner_blend(_e2, 1, 1, 1, seed_8);
    Vol_Blend _e53 = vol_blend(along_x, u_4, _e24, _e28);
    Vol_Blend _e54 = vol_blend(along_x, u_4, _e32, _e36);
    Vol_Blend _e55 = vol_blend(along_x, u_4, _e40, _e44);
    Vol_Blend _e56 = vol_blend(along_x, u_4, _e48, _e52);
    Vol_Blend _e57 = vol_blend(along_y, v_5, _e53, _e54);
    Vol_Blend _e58 = vol_blend(along_y, v_5, _e55, _e56);
    Vol_Blend _e59 = vol_blend(along_z, w_4, _e57, _e58);
    float _e64 = vol_fade_slope(_e2.place.x);
    float dx = (_e59.gradient.x + (_e64 * _e59.slope.x));
    float _e73 = vol_fade_slope(_e2.place.y);
    float dy = (_e59.gradient.y + (_e73 * _e59.slope.y));
    float _e82 = vol_fade_slope(_e2.place.z);
    float dz = (_e59.gradient.z + (_e82 * _e59.slope.z));
    return vec4(_e59.value, dx, dy, dz);
}

int vol_octave_count(float octaves) {
    float _e3 = vol_hold(octaves, 0.0, VOL_OCTAVES);
    return int(floor(_e3));
}

float vol_next_octave(float product, float factor) {
    float _e5 = vol_hold((product * factor), -1099511600000.0, VOL_PRODUCT);
    return _e5;
}

float vol_fbm(vec3 p_4, float octaves_1, float lacunarity, float gain, uint seed_9) {
    float sum_1 = 0.0;
    float amplitude = 1.0;
    float frequency = 1.0;
    int k_3 = 0;
    int _e11 = vol_octave_count(octaves_1);
    bool loop_init = true;
    while(true) {
        if (!loop_init) {
            int _e35 = k_3;
            k_3 = (_e35 + 1);
        }
        loop_init = false;
        int _e14 = k_3;
        if ((_e14 < _e11)) {
        } else {
            break;
        }
        {
            float _e17 = frequency;
            float _e20 = frequency;
            float _e23 = frequency;
            vec3 q_1 = vec3((p_4.x * _e17), (p_4.y * _e20), (p_4.z * _e23));
            float _e26 = sum_1;
            float _e27 = amplitude;
            float _e28 = vol_perlin(q_1, seed_9);
            sum_1 = (_e26 + (_e27 * _e28));
            float _e31 = amplitude;
            float _e32 = vol_next_octave(_e31, gain);
            amplitude = _e32;
            float _e33 = frequency;
            float _e34 = vol_next_octave(_e33, lacunarity);
            frequency = _e34;
        }
    }
    float _e38 = sum_1;
    return _e38;
}

vec4 vol_fbm_gradient(vec3 p_5, float octaves_2, float lacunarity_1, float gain_1, uint seed_10) {
    vec4 sum_2 = vec4(0.0, 0.0, 0.0, 0.0);
    float amplitude_1 = 1.0;
    float frequency_1 = 1.0;
    int k_4 = 0;
    int _e15 = vol_octave_count(octaves_2);
    bool loop_init_1 = true;
    while(true) {
        if (!loop_init_1) {
            int _e43 = k_4;
            k_4 = (_e43 + 1);
        }
        loop_init_1 = false;
        int _e18 = k_4;
        if ((_e18 < _e15)) {
        } else {
            break;
        }
        {
            float _e21 = frequency_1;
            float _e24 = frequency_1;
            float _e27 = frequency_1;
            vec3 q_2 = vec3((p_5.x * _e21), (p_5.y * _e24), (p_5.z * _e27));
            vec4 _e30 = vol_perlin_gradient(q_2, seed_10);
            float _e31 = amplitude_1;
            float _e32 = frequency_1;
            float steepness = (_e31 * _e32);
            float _e34 = amplitude_1;
            vec4 weights_4 = vec4(_e34, steepness, steepness, steepness);
            vec4 _e36 = sum_2;
            sum_2 = (_e36 + (weights_4 * _e30));
            float _e39 = amplitude_1;
            float _e40 = vol_next_octave(_e39, gain_1);
            amplitude_1 = _e40;
            float _e41 = frequency_1;
            float _e42 = vol_next_octave(_e41, lacunarity_1);
            frequency_1 = _e42;
        }
    }
    vec4 _e46 = sum_2;
    return _e46;
}

float vol_dot(vec3 a_3, vec3 b_3) {
    return (((a_3.x * b_3.x) + (a_3.y * b_3.y)) + (a_3.z * b_3.z));
}

vec3 vol_cross(vec3 a_4, vec3 b_4) {
    return vec3(((a_4.y * b_4.z) - (a_4.z * b_4.y)), ((a_4.z * b_4.x) - (a_4.x * b_4.z)), ((a_4.x * b_4.y) - (a_4.y * b_4.x)));
}

vec3 vol_curve_vector(uint word_2) {
    float _e1 = vol_curve_word(word_2);
    float _e4 = vol_curve_word((word_2 + 1u));
    float _e7 = vol_curve_word((word_2 + 2u));
    return vec3(_e1, _e4, _e7);
}

vec3 vol_held_point(vec3 p_6) {
    float _e4 = vol_hold(p_6.x, -100000000.0, VOL_REACH);
    float _e8 = vol_hold(p_6.y, -100000000.0, VOL_REACH);
    float _e12 = vol_hold(p_6.z, -100000000.0, VOL_REACH);
    return vec3(_e4, _e8, _e12);
}

vec3 vol_from_point(vec3 p_7, uint word_3) {
    vec3 _e2 = vol_curve_vector(word_3);
    vec3 _e6 = vol_curve_vector((word_3 + 3u));
    return ((_e2 - p_7) + _e6);
}

vec3 vol_reach(vec3 w_1, vec3 b1_, vec3 b2_, float t_5) {
    return (w_1 + (t_5 * ((2.0 * b1_) + (t_5 * b2_))));
}

vec3 vol_end_from_point(vec3 p_8, uint word_4) {
    vec3 _e4 = vol_curve_vector((word_4 + 40u));
    vec3 _e8 = vol_curve_vector((word_4 + 43u));
    return ((_e4 - p_8) + _e8);
}

vec3 vol_offset_at(vec3 p_9, uint word_5, vec3 b1_1, vec3 b2_1, float t_6) {
    vec3 _e5 = vol_from_point(p_9, word_5);
    vec3 _e6 = vol_reach(_e5, b1_1, b2_1, t_6);
    float back_2 = (1.0 - t_6);
    vec3 _e9 = vol_end_from_point(p_9, word_5);
    vec3 before_7 = (_e9 - (back_2 * ((2.0 * (b1_1 + b2_1)) - (back_2 * b2_1))));
    return ((t_6 > 0.5) ? before_7 : _e6);
}

float vol_rough_cube_root(float x_14) {
    return uintBitsToFloat(((floatBitsToUint(x_14) / 3u) + 709921077u));
}

float vol_depressed_step(float u, float gap3_, float m, float k_5) {
    float value_3 = (((((u + gap3_) * u) + m) * u) - k_5);
    float slope_8 = ((((3.0 * u) + (2.0 * gap3_)) * u) + m);
    return max((u - (value_3 / max(slope_8, VOL_TINY))), 0.0);
}

float vol_polish_step(float t_7, float a3_, float a2x3_, float a1_, float a0_, float low_1) {
    float value_4 = ((((((a3_ * t_7) + a2x3_) * t_7) + a1_) * t_7) + a0_);
    float slope_9 = (((((3.0 * a3_) * t_7) + (2.0 * a2x3_)) * t_7) + a1_);
    float _e25 = vol_hold((t_7 - (value_4 / max(slope_9, VOL_TINY))), low_1, 1.0);
    return _e25;
}

Vol_Inner vol_inner(vec3 p_10, uint word_6) {
    vec3 _e4 = vol_curve_vector((word_6 + 6u));
    vec3 _e7 = vol_curve_vector((word_6 + 9u));
    float _e10 = vol_curve_word((word_6 + 27u));
    float _e13 = vol_curve_word((word_6 + 28u));
    vec3 _e14 = vol_from_point(p_10, word_6);
    float _e17 = vol_curve_word((word_6 + 24u));
    float _e20 = vol_curve_word((word_6 + 25u));
    float a2x3_1 = (3.0 * _e20);
    float _e25 = vol_curve_word((word_6 + 26u));
    float _e28 = vol_dot(_e14, _e7);
    float a1_2 = ((2.0 * _e25) + _e28);
    float _e30 = vol_dot(_e14, _e4);
    float slope_10 = ((a1_2 + (a2x3_1 * _e10)) * _e13);
    float half_gap = sqrt(max((-(slope_10) * 0.33333334), 0.0));
    float m_2 = max(slope_10, 0.0);
    float e_1 = (_e10 + half_gap);
    float at_e = (((((((_e17 * e_1) + a2x3_1) * e_1) + a1_2) * e_1) + _e30) * _e13);
    float k_8 = max(-(at_e), 0.0);
    float gap3_1 = (3.0 * half_gap);
    float tiny = ((1e-12 * k_8) + VOL_TINY);
    float by_square = sqrt((k_8 / max(gap3_1, tiny)));
    float by_line = (k_8 / max(m_2, tiny));
    float _e64 = vol_rough_cube_root(k_8);
    float u0_ = min(min(_e64, by_square), by_line);
    float _e67 = vol_depressed_step(u0_, gap3_1, m_2, k_8);
    float _e68 = vol_depressed_step(_e67, gap3_1, m_2, k_8);
    bool is_flat = (_e13 == 0.0);
    float _e73 = vol_hold(e_1, 0.0, 1.0);
    float low_2 = (is_flat ? 0.0 : _e73);
    float _e78 = vol_hold((e_1 + _e68), low_2, 1.0);
    float t0_ = (is_flat ? 0.5 : _e78);
    float _e81 = vol_polish_step(t0_, _e17, a2x3_1, a1_2, _e30, low_2);
    float _e82 = vol_polish_step(_e81, _e17, a2x3_1, a1_2, _e30, low_2);
    vec3 _e83 = vol_reach(_e14, _e4, _e7, _e82);
    bool dips = ((!(is_flat) && (k_8 > 0.0)) && ((e_1 > 0.0) && (e_1 < 1.0)));
    bool start_is_least = ((_e30 > 0.0) || ((_e30 == 0.0) && (a1_2 >= 0.0)));
    float _e102 = vol_dot(_e83, _e83);
    float _e103 = vol_dot(_e14, _e14);
    return Vol_Inner(_e82, _e102, start_is_least, _e103, dips);
}

Vol_Foot vol_foot(vec3 p_11, uint word_7) {
    Vol_Inner _e2 = vol_inner(p_11, word_7);
    bool start_wins = (_e2.start_is_least && (_e2.start_sq <= _e2.dist_sq));
    return Vol_Foot((start_wins ? 0.0 : _e2.t), (start_wins ? _e2.start_sq : _e2.dist_sq));
}

bool vol_at_first(uint word_8, float t_8) {
    float _e4 = vol_curve_word((word_8 + 32u));
    return ((_e4 * (t_8 - 0.5)) <= -0.5);
}

bool vol_at_last(uint word_9, float t_9) {
    float _e4 = vol_curve_word((word_9 + 32u));
    return ((_e4 * (t_9 - 0.5)) >= 0.5);
}

Vol_Search vol_visit(Vol_Search before, vec3 p_12, uint word_10, uint index_5) {
    Vol_Foot _e4 = vol_foot(p_12, word_10);
    bool _e6 = vol_at_last(word_10, _e4.t);
    float _e9 = vol_curve_word((word_10 + 38u));
    bool defers = (_e6 && (_e9 == 1.0));
    bool _e14 = vol_at_first(word_10, _e4.t);
    float _e17 = vol_curve_word((word_10 + 37u));
    bool redundant = ((_e14 && (_e17 == 1.0)) && !(before.left_at_last));
    bool wins = (((_e4.dist_sq < before.dist_sq) && !(defers)) && !(redundant));
    return Vol_Search((wins ? _e4.dist_sq : before.dist_sq), (wins ? _e4.t : before.t), (wins ? index_5 : before.piece), _e6);
}

float vol_length_to(uint word_11, float t_10) {
    float _e4 = vol_curve_word((word_11 + 24u));
    float _e7 = vol_curve_word((word_11 + 26u));
    float _e10 = vol_curve_word((word_11 + 33u));
    float _e14 = vol_curve_word((word_11 + 25u));
    float rate = ((_e4 * t_10) + (2.0 * _e14));
    float speed0_ = sqrt(_e7);
    float speed = sqrt(((rate * t_10) + _e7));
    float rise_1 = ((t_10 * rate) / max((speed + speed0_), VOL_TINY));
    float _e32 = vol_curve_word((word_11 + 35u));
    float z_9 = ((_e10 * ((_e10 * t_10) + rise_1)) / _e32);
    float y_11 = (z_9 / (2.0 + z_9));
    float yy = (y_11 * y_11);
    float s3_ = (0.14285715 + (yy * 0.11111111));
    float s2_ = (0.2 + (yy * s3_));
    float s1_ = (0.33333334 + (yy * s2_));
    float series = ((2.0 * y_11) * (1.0 + (yy * s1_)));
    float _e56 = vol_log2_((1.0 + z_9));
    float logarithm = (_e56 * VOL_LN_2_);
    float log_term = ((z_9 < 0.414) ? series : logarithm);
    float _e65 = vol_curve_word((word_11 + 27u));
    float _e70 = vol_curve_word((word_11 + 34u));
    float bent = ((t_10 * speed) + ((-(_e65) * rise_1) + (_e70 * log_term)));
    float _e79 = vol_curve_word((word_11 + 28u));
    return ((_e79 == 0.0) ? ((2.0 * speed0_) * t_10) : bent);
}

Vol_CurvePoint vol_describe(vec3 p_13, uint word_12, float t_11) {
    vec3 _e5 = vol_curve_vector((word_12 + 6u));
    vec3 _e8 = vol_curve_vector((word_12 + 9u));
    vec3 _e11 = vol_curve_vector((word_12 + 12u));
    vec3 _e14 = vol_curve_vector((word_12 + 15u));
    vec3 _e17 = vol_curve_vector((word_12 + 18u));
    vec3 _e20 = vol_curve_vector((word_12 + 21u));
    float _e23 = vol_curve_word((word_12 + 30u));
    float _e26 = vol_curve_word((word_12 + 32u));
    float _e29 = vol_curve_word((word_12 + 39u));
    vec3 _e30 = vol_offset_at(p_13, word_12, _e5, _e8, t_11);
    vec3 v_6 = (_e5 + (t_11 * _e8));
    float _e33 = vol_dot(v_6, v_6);
    float vv = max(_e33, VOL_TINY);
    float _e38 = vol_curve_word((word_12 + 36u));
    bool is_straight = (_e38 != 0.0);
    float per_speed = (_e26 / sqrt(vv));
    vec3 tangent_1 = (is_straight ? _e11 : (v_6 * per_speed));
    vec3 sum_5 = (_e11 + tangent_1);
    float _e46 = vol_dot(_e30, sum_5);
    float _e47 = vol_dot(_e11, sum_5);
    float turn = (_e46 / _e47);
    float _e49 = vol_dot(_e14, tangent_1);
    float _e51 = vol_dot(_e30, _e14);
    float x_26 = ((_e49 * turn) - _e51);
    float _e53 = vol_dot(_e17, tangent_1);
    float _e55 = vol_dot(_e30, _e17);
    float y_12 = ((_e53 * turn) - _e55);
    float _e57 = vol_dot(_e30, tangent_1);
    float ahead_4 = -(_e57);
    bool _e59 = vol_at_first(word_12, t_11);
    float _e62 = vol_curve_word((word_12 + 37u));
    bool starts = (_e59 && (_e62 == 0.0));
    bool _e66 = vol_at_last(word_12, t_11);
    float _e72 = vol_curve_word((word_12 + 38u));
    bool ends_2 = ((_e66 || (_e23 == 0.0)) && (_e72 == 0.0));
    float behind_first = (starts ? -(ahead_4) : 0.0);
    float beyond_last = (ends_2 ? ahead_4 : 0.0);
    vec3 _e81 = vol_cross(_e20, v_6);
    float _e82 = vol_dot(_e30, _e81);
    float bent_1 = (_e82 / vv);
    float stretch = (1.0 + (bent_1 / (2.0 * vv)));
    float _e91 = vol_curve_word((word_12 + 31u));
    float _e92 = vol_length_to(word_12, t_11);
    float s_4 = (_e91 + (_e26 * _e92));
    float _e97 = vol_curve_word((word_12 + 29u));
    float _e102 = vol_hold((_e97 + (_e23 * t_11)), 0.0, 1.0);
    float _e104 = vol_hold(s_4, 0.0, _e29);
    float _e105 = vol_dot(_e30, _e30);
    float _e112 = vol_hold(stretch, 0.0, VOL_STRETCH);
    return Vol_CurvePoint(_e102, _e104, _e29, x_26, y_12, sqrt(_e105), max(max(behind_first, beyond_last), 0.0), _e112);
}

Vol_CurveSlopes vol_slopes(vec3 p_14, uint word_13, float t_12) {
    vec3 _e5 = vol_curve_vector((word_13 + 6u));
    vec3 _e8 = vol_curve_vector((word_13 + 9u));
    vec3 _e11 = vol_curve_vector((word_13 + 12u));
    vec3 _e14 = vol_curve_vector((word_13 + 21u));
    float _e17 = vol_curve_word((word_13 + 30u));
    vec3 _e18 = vol_from_point(p_14, word_13);
    vec3 _e19 = vol_reach(_e18, _e5, _e8, t_12);
    vec3 v_7 = (_e5 + (t_12 * _e8));
    float _e22 = vol_dot(v_7, v_7);
    float vv_1 = max(_e22, VOL_TINY);
    float _e27 = vol_curve_word((word_13 + 36u));
    bool is_straight_1 = (_e27 != 0.0);
    float speed_1 = sqrt(vv_1);
    float _e33 = vol_curve_word((word_13 + 32u));
    float per_speed_1 = (_e33 / speed_1);
    vec3 tangent_2 = (is_straight_1 ? _e11 : (v_7 * per_speed_1));
    float _e37 = vol_dot(_e19, _e19);
    float distance_10 = sqrt(_e37);
    float per_distance = ((distance_10 > 0.0) ? (-1.0 / max(distance_10, VOL_TINY)) : 0.0);
    bool at_end = ((t_12 == 0.0) || (t_12 == 1.0));
    float _e52 = vol_dot(_e19, tangent_2);
    bool held_1 = (at_end && (abs(_e52) > (VOL_LEAN * distance_10)));
    vec3 _e58 = vol_cross(_e14, v_7);
    float _e59 = vol_dot(_e19, _e58);
    float bent_2 = (_e59 / vv_1);
    float stretch_1 = max((1.0 + (bent_2 / (2.0 * vv_1))), VOL_LEAST_STRETCH);
    return Vol_CurveSlopes((_e19 * per_distance), tangent_2, min((abs(_e17) / (2.0 * speed_1)), VOL_LARGEST_RATE), ((held_1 || (_e17 == 0.0)) ? 0.0 : (1.0 / stretch_1)));
}

float vol_box_dist_sq(vec3 p_15, uint word_14) {
    vec3 _e4 = vol_curve_vector((word_14 + 52u));
    vec3 below = (_e4 - p_15);
    vec3 _e8 = vol_curve_vector((word_14 + 55u));
    vec3 above = (p_15 - _e8);
    float x_27 = max(max(below.x, above.x), 0.0);
    float y_13 = max(max(below.y, above.y), 0.0);
    float z_10 = max(max(below.z, above.z), 0.0);
    return (((x_27 * x_27) + (y_13 * y_13)) + (z_10 * z_10));
}

Vol_Search vol_search(vec3 p_16, Vol_Curve curve) {
    Vol_Search search = Vol_Search(3.4028235e38, 0.0, 0u, false);
    uint index_6 = 0u;
    Vol_LastSearch last_4 = vol_last_search[curve.number];
    if ((last_4.some && all(equal(last_4.point, p_16)))) {
        return last_4.found;
    }
    vec3 way = (p_16 - last_4.point);
    float _e15 = vol_dot(way, way);
    float reach_1 = (last_4.reach + sqrt(_e15));
    float bound = (last_4.some ? ((reach_1 * reach_1) * VOL_LOOSE) : VOL_LARGEST);
    bool loop_init_2 = true;
    while(true) {
        if (!loop_init_2) {
            uint _e45 = index_6;
            index_6 = (_e45 + 1u);
        }
        loop_init_2 = false;
        uint _e32 = index_6;
        if ((_e32 < curve.count)) {
        } else {
            break;
        }
        {
            uint _e36 = index_6;
            uint word_15 = ((curve.first + _e36) * VOL_PIECE_WORDS);
            float _e40 = vol_box_dist_sq(p_16, word_15);
            if ((_e40 <= bound)) {
                Vol_Search _e42 = search;
                uint _e43 = index_6;
                Vol_Search _e44 = vol_visit(_e42, p_16, word_15, _e43);
                search = _e44;
            }
        }
    }
    float _e54 = vol_curve_word(((curve.first * VOL_PIECE_WORDS) + 39u));
    float slack = (VOL_SLACK * _e54);
    Vol_Search _e60 = search;
    float _e62 = search.dist_sq;
    vol_last_search[curve.number] = Vol_LastSearch(true, p_16, _e60, (sqrt(_e62) + slack));
    Vol_Search _e66 = search;
    return _e66;
}

Vol_CurveSlopes vol_closest_gradient(vec3 point, Vol_Curve curve_1) {
    vec3 _e2 = vol_held_point(point);
    Vol_Search _e3 = vol_search(_e2, curve_1);
    if ((curve_1.count == 0u)) {
        return Vol_CurveSlopes(vec3(1.0, 0.0, 0.0), vec3(0.0, 0.0, 1.0), 0.0, 0.0);
    }
    Vol_CurveSlopes _e24 = vol_slopes(_e2, ((curve_1.first + _e3.piece) * VOL_PIECE_WORDS), _e3.t);
    return _e24;
}

Vol_CurvePoint vol_closest(vec3 point_1, Vol_Curve curve_2) {
    vec3 _e2 = vol_held_point(point_1);
    Vol_Search _e3 = vol_search(_e2, curve_2);
    if ((curve_2.count == 0u)) {
        return Vol_CurvePoint(0.0, 0.0, 0.0, 1e18, 0.0, 1e18, 0.0, 1.0);
    }
    Vol_CurvePoint _e22 = vol_describe(_e2, ((curve_2.first + _e3.piece) * VOL_PIECE_WORDS), _e3.t);
    return _e22;
}

float vol_f2_region_cloud(float x0_, float x1_, float x2_) {
    Vol_CurvePoint _e17 = vol_closest(vec3(x0_, x1_, x2_), Vol_Curve(0u, 2u, 0u));
    float v13_ = _e17.t;
    float v14_ = _e17.arc_length;
    float v15_ = _e17.curve_length;
    float v16_ = _e17.distance_;
    float v17_ = _e17.overshoot;
    float v18_ = (v13_ * v13_);
    float v19_ = (v18_ * 0.52);
    float v20_ = (0.08 + v19_);
    float v22_ = ((v20_ > 1e-6) ? v20_ : 1e-6);
    float v23_ = (v16_ - v22_);
    float v24_ = (v16_ - 0.6);
    float v25_ = (v23_ * 0.79870445);
    float v27_ = ((v25_ < 0.5264106) ? v25_ : 0.5264106);
    float v28_ = ((v24_ > v27_) ? v24_ : v27_);
    bool v29_ = (v16_ < 1.1264106);
    float v30_ = (v29_ ? v28_ : v24_);
    float v31_ = (1000000000000000.0 - v16_);
    float v32_ = ((v17_ < v31_) ? v17_ : v31_);
    float v33_ = (v15_ - v14_);
    float v34_ = ((v14_ < v33_) ? v14_ : v33_);
    float v35_ = (v34_ * 0.69090724);
    float v36_ = ((v35_ < 1.5609045) ? v35_ : 1.5609045);
    float v37_ = -(v36_);
    bool v38_ = (0.0 < v17_);
    float v39_ = (v38_ ? v32_ : v37_);
    float v40_ = ((v30_ > v39_) ? v30_ : v39_);
    return v40_;
}

Vol_Out10_ vol_f3_interior_cloud(float x0_1, float x1_1, float x2_1) {
    Vol_CurvePoint _e14 = vol_closest(vec3(x0_1, x1_1, x2_1), Vol_Curve(0u, 2u, 0u));
    float v10_ = _e14.t;
    float v11_ = _e14.arc_length;
    float v12_ = _e14.x;
    float v13_1 = _e14.y;
    float v14_1 = (v10_ * v10_);
    float v15_1 = (v14_1 * 0.52);
    float v16_1 = (0.08 + v15_1);
    float v18_1 = ((v16_1 > 1e-6) ? v16_1 : 1e-6);
    float v20_1 = (5.0265484 * v10_);
    float v22_1 = (v20_1 - 0.0);
    float _e29 = vol_sin(v22_1);
    float _e30 = vol_cos(v22_1);
    float v25_1 = (_e30 * v12_);
    float v26_ = (_e29 * v13_1);
    float v27_1 = (_e29 * v12_);
    float v28_1 = (_e30 * v13_1);
    float v29_1 = (v25_1 - v26_);
    float v30_1 = (v27_1 + v28_1);
    float v31_1 = (v29_1 / v18_1);
    float v32_1 = (v30_1 / v18_1);
    float v35_1 = (v31_1 * 3.0);
    float v36_1 = (v11_ * 6.0);
    float v37_1 = (v32_1 * 3.0);
    float v38_1 = (v36_1 - 0.0);
    float _e50 = vol_fbm(vec3(v35_1, v38_1, v37_1), 5.0, 2.0, 0.5, 0u);
    float v44_ = (_e50 + 0.15);
    float v45_ = (25.0 * v44_);
    return Vol_Out10_(v45_, 0.7912979, 0.8307699, 1.0, 0.94129795, 0.9807699, 1.15, 0.0, 0.0, 0.0);
}

vec4 vol_f4_extinction_cloud(float x0_2, float x1_2, float x2_2) {
    Vol_CurvePoint _e12 = vol_closest(vec3(x0_2, x1_2, x2_2), Vol_Curve(0u, 2u, 0u));
    float v8_ = _e12.t;
    float v9_ = _e12.arc_length;
    float v10_1 = _e12.x;
    float v11_1 = _e12.y;
    float v12_1 = (v8_ * v8_);
    float v13_2 = (v12_1 * 0.52);
    float v14_2 = (0.08 + v13_2);
    float v16_2 = ((v14_2 > 1e-6) ? v14_2 : 1e-6);
    float v18_2 = (5.0265484 * v8_);
    float v20_2 = (v18_2 - 0.0);
    float _e27 = vol_sin(v20_2);
    float _e28 = vol_cos(v20_2);
    float v23_1 = (_e28 * v10_1);
    float v24_1 = (_e27 * v11_1);
    float v25_2 = (_e27 * v10_1);
    float v26_1 = (_e28 * v11_1);
    float v27_2 = (v23_1 - v24_1);
    float v28_2 = (v25_2 + v26_1);
    float v29_2 = (v27_2 / v16_2);
    float v30_2 = (v28_2 / v16_2);
    float v33_1 = (v29_2 * 3.0);
    float v34_1 = (v9_ * 6.0);
    float v35_2 = (v30_2 * 3.0);
    float v36_2 = (v34_1 - 0.0);
    float _e48 = vol_fbm(vec3(v33_1, v36_2, v35_2), 5.0, 2.0, 0.5, 0u);
    float v42_ = (_e48 + 0.15);
    float v43_ = (25.0 * v42_);
    return vec4(v43_, 0.94129795, 0.9807699, 1.15);
}

float vol_f5_phase_cloud(float x0_3, float x1_3) {
    float v3_ = (0.6 * x0_3);
    float v4_ = (0.49 + v3_);
    float v5_ = sqrt(((v4_ > 0.0) ? v4_ : 0.0));
    float v6_ = (v4_ * v5_);
    float v8_1 = (12.566371 * v6_);
    float v10_2 = (0.91 / v8_1);
    return v10_2;
}

float vol_f7_density_cloud(float x0_4, float x1_4, float x2_3) {
    Vol_CurvePoint _e19 = vol_closest(vec3(x0_4, x1_4, x2_3), Vol_Curve(0u, 2u, 0u));
    float v15_2 = _e19.t;
    float v16_3 = _e19.arc_length;
    float v17_1 = _e19.curve_length;
    float v18_3 = _e19.x;
    float v19_1 = _e19.y;
    float v20_3 = _e19.distance_;
    float v21_ = _e19.overshoot;
    float v22_2 = (v15_2 * v15_2);
    float v23_2 = (v22_2 * 0.52);
    float v24_2 = (0.08 + v23_2);
    float v26_2 = ((v24_2 > 1e-6) ? v24_2 : 1e-6);
    float v28_3 = (5.0265484 * v15_2);
    float v30_3 = (v28_3 - 0.0);
    float _e37 = vol_sin(v30_3);
    float _e38 = vol_cos(v30_3);
    float v33_2 = (_e38 * v18_3);
    float v34_2 = (_e37 * v19_1);
    float v35_3 = (_e37 * v18_3);
    float v36_3 = (_e38 * v19_1);
    float v37_2 = (v33_2 - v34_2);
    float v38_2 = (v35_3 + v36_3);
    float v39_1 = (v37_2 / v26_2);
    float v40_1 = (v38_2 / v26_2);
    float v43_1 = (v39_1 * 3.0);
    float v44_1 = (v16_3 * 6.0);
    float v45_1 = (v40_1 * 3.0);
    float v46_ = (v44_1 - 0.0);
    float _e58 = vol_fbm(vec3(v43_1, v46_, v45_1), 5.0, 2.0, 0.5, 0u);
    float v52_ = (_e58 + 0.15);
    float v53_ = (25.0 * v52_);
    float v54_ = (v20_3 - v26_2);
    float v55_ = (v20_3 - 0.6);
    float v56_ = (v54_ * 0.79870445);
    float v58_ = ((v56_ < 0.5264106) ? v56_ : 0.5264106);
    float v59_ = ((v55_ > v58_) ? v55_ : v58_);
    bool v60_ = (v20_3 < 1.1264106);
    float v61_ = (v60_ ? v59_ : v55_);
    float v62_ = (1000000000000000.0 - v20_3);
    float v63_ = ((v21_ < v62_) ? v21_ : v62_);
    float v64_ = (v17_1 - v16_3);
    float v65_ = ((v16_3 < v64_) ? v16_3 : v64_);
    float v66_ = (v65_ * 0.69090724);
    float v67_ = ((v66_ < 1.5609045) ? v66_ : 1.5609045);
    float v68_ = -(v67_);
    bool v69_ = (0.0 < v21_);
    float v70_ = (v69_ ? v63_ : v68_);
    float v71_ = ((v61_ > v70_) ? v61_ : v70_);
    bool v72_ = (0.0 < v71_);
    float v73_ = ((v53_ > 0.0) ? v53_ : 0.0);
    float v74_ = (v72_ ? 0.0 : v73_);
    return v74_;
}

vec3 vol_f8_colour_cloud(float x0_5, float x1_5, float x2_4) {
    return vec3(0.7912979, 0.8307699, 1.0);
}

vec3 vol_f9_local_cloud(float x0_6, float x1_6, float x2_5) {
    Vol_CurvePoint _e10 = vol_closest(vec3(x0_6, x1_6, x2_5), Vol_Curve(0u, 2u, 0u));
    float v6_1 = _e10.t;
    float v7_ = _e10.arc_length;
    float v8_2 = _e10.x;
    float v9_1 = _e10.y;
    float v10_3 = (v6_1 * v6_1);
    float v11_2 = (v10_3 * 0.52);
    float v12_2 = (0.08 + v11_2);
    float v14_3 = ((v12_2 > 1e-6) ? v12_2 : 1e-6);
    float v16_4 = (5.0265484 * v6_1);
    float v18_4 = (v16_4 - 0.0);
    float _e25 = vol_sin(v18_4);
    float _e26 = vol_cos(v18_4);
    float v21_1 = (_e26 * v8_2);
    float v22_3 = (_e25 * v9_1);
    float v23_3 = (_e25 * v8_2);
    float v24_3 = (_e26 * v9_1);
    float v25_3 = (v21_1 - v22_3);
    float v26_3 = (v23_3 + v24_3);
    float v27_3 = (v25_3 / v14_3);
    float v28_4 = (v26_3 / v14_3);
    return vec3(v27_3, v7_, v28_4);
}

bool vol_in_joins_the_one_before(uint object) {
    return false;
}

float vol_in_object_distance(uint index_7, vec3 p_17) {
    do {
        return VOL_IN_FAR;
    } while(false);
}

vec3 vol_in_object_gradient(uint index_8, vec3 p_18) {
    do {
        return vec3(0.0);
    } while(false);
}

float vol_in_object_steepness(uint index_9, vec3 lo, vec3 hi) {
    do {
        return 1.0;
    } while(false);
}

Vol_in_Response vol_in_object_surface(uint index_10, vec3 p_19) {
    do {
        return Vol_in_Response(vec3(0.0), vec3(0.0), vec3(0.0), 0.0);
    } while(false);
}

float vol_in_medium_region(uint index_11, vec3 p_20) {
    switch(index_11) {
        case 0u: {
            float _e5 = vol_f2_region_cloud(p_20.x, p_20.y, p_20.z);
            return _e5;
        }
        default: {
            return VOL_IN_FAR;
        }
    }
}

Vol_in_Interior vol_in_medium_interior(uint index_12, vec3 p_21) {
    switch(index_12) {
        case 0u: {
            Vol_Out10_ _e5 = vol_f3_interior_cloud(p_21.x, p_21.y, p_21.z);
            return Vol_in_Interior(_e5.v0_, vec3(_e5.v1_, _e5.v2_, _e5.v3_), vec3(_e5.v4_, _e5.v5_, _e5.v6_), vec3(_e5.v7_, _e5.v8_, _e5.v9_));
        }
        default: {
            return Vol_in_Interior(0.0, vec3(0.0), vec3(0.0), vec3(0.0));
        }
    }
}

vec4 vol_in_medium_extinction(uint index_13, vec3 p_22) {
    switch(index_13) {
        case 0u: {
            vec4 _e5 = vol_f4_extinction_cloud(p_22.x, p_22.y, p_22.z);
            return _e5;
        }
        default: {
            return vec4(0.0);
        }
    }
}

float vol_in_medium_phase(uint index_14, float less, float more) {
    switch(index_14) {
        case 0u: {
            float _e3 = vol_f5_phase_cloud(less, more);
            return _e3;
        }
        default: {
            return 0.0;
        }
    }
}

vec3 vol_in_word3_(uint at) {
    float _e1 = vol_frame_word(at);
    float _e4 = vol_frame_word((at + 1u));
    float _e7 = vol_frame_word((at + 2u));
    return vec3(_e1, _e4, _e7);
}

vec3 vol_in_input3_(uint at_1) {
    float _e1 = vol_input_word(at_1);
    float _e4 = vol_input_word((at_1 + 1u));
    float _e7 = vol_input_word((at_1 + 2u));
    return vec3(_e1, _e4, _e7);
}

float vol_in_dot3_(vec3 a_5, vec3 b_5) {
    return (((a_5.x * b_5.x) + (a_5.y * b_5.y)) + (a_5.z * b_5.z));
}

float vol_in_length3_(vec3 v) {
    float _e1 = vol_in_dot3_(v, v);
    return sqrt(_e1);
}

float vol_in_largest(vec3 v_1) {
    return max(max(v_1.x, v_1.y), v_1.z);
}

float vol_in_smallest(vec3 v_2) {
    return min(min(v_2.x, v_2.y), v_2.z);
}

float vol_in_decay(float x_15) {
    float _e3 = vol_exp2_((x_15 * -1.442695));
    return _e3;
}

vec3 vol_in_decay3_(vec3 x_16) {
    float _e2 = vol_in_decay(x_16.x);
    float _e4 = vol_in_decay(x_16.y);
    float _e6 = vol_in_decay(x_16.z);
    return vec3(_e2, _e4, _e6);
}

float vol_in_mean_decay(float x_17) {
    float tail = (x_17 * (0.008333334 - (x_17 * 0.0013888889)));
    float series_1 = (1.0 - (x_17 * (0.5 - (x_17 * (0.16666667 - (x_17 * (0.041666668 - tail)))))));
    float _e17 = vol_in_decay(x_17);
    float quotient = ((1.0 - _e17) / max(x_17, 0.35));
    return ((x_17 < 0.35) ? series_1 : quotient);
}

vec3 vol_in_mean_decay3_(vec3 x_18) {
    float _e2 = vol_in_mean_decay(x_18.x);
    float _e4 = vol_in_mean_decay(x_18.y);
    float _e6 = vol_in_mean_decay(x_18.z);
    return vec3(_e2, _e4, _e6);
}

float vol_in_decay_moment(float x_19) {
    float tail_1 = (x_19 * (0.0069444445 - (x_19 * (0.0011904762 - (x_19 * 0.00017361112)))));
    float series_2 = (0.5 - (x_19 * (0.33333334 - (x_19 * (0.125 - (x_19 * (0.033333335 - tail_1)))))));
    float _e20 = vol_in_mean_decay(x_19);
    float _e21 = vol_in_decay(x_19);
    float quotient_1 = ((_e20 - _e21) / max(x_19, 0.5));
    return ((x_19 < 0.5) ? series_2 : quotient_1);
}

vec3 vol_in_decay_moment3_(vec3 x_20) {
    float _e2 = vol_in_decay_moment(x_20.x);
    float _e4 = vol_in_decay_moment(x_20.y);
    float _e6 = vol_in_decay_moment(x_20.z);
    return vec3(_e2, _e4, _e6);
}

float vol_in_power(float x_21, float y_6) {
    bool some_1 = (x_21 > 0.0);
    float _e6 = vol_log2_((some_1 ? x_21 : 1.0));
    float _e8 = vol_exp2_((y_6 * _e6));
    return (some_1 ? _e8 : 0.0);
}

bool vol_in_is_within(Vol_in_Mean mean, float tolerance) {
    bool local = false;
    float count_4 = float(mean.count);
    float scaled_1 = ((tolerance * tolerance) * (count_4 * (count_4 - 1.0)));
    float _e12 = vol_in_dot3_(mean.color, mean.color);
    float color_1 = (scaled_1 * max(_e12, 0.01171875));
    float transmittance = (scaled_1 * 3.0);
    if ((mean.color_spread <= color_1)) {
        local = (mean.transmittance_spread <= transmittance);
    } else {
        local = false;
    }
    bool _e24 = local;
    return _e24;
}

bool vol_in_is_done(Vol_in_Mean mean_1) {
    bool local_1 = false;
    bool local_2 = false;
    bool local_3 = false;
    float _e3 = vol_frame_word(VOL_IN_AT_SAMPLES);
    if ((mean_1.count >= uint(_e3))) {
        return true;
    }
    if ((mean_1.count >= VOL_IN_FIRST_ROUND)) {
        local_1 = (((mean_1.count - VOL_IN_FIRST_ROUND) % VOL_IN_ROUND) == 0u);
    } else {
        local_1 = false;
    }
    bool tested = local_1;
    float _e22 = vol_frame_word(VOL_IN_AT_TOLERANCE);
    if (tested) {
        local_2 = (_e22 > 0.0);
    } else {
        local_2 = false;
    }
    bool _e28 = local_2;
    if (_e28) {
        bool _e31 = vol_in_is_within(mean_1, _e22);
        local_3 = _e31;
    } else {
        local_3 = false;
    }
    bool _e33 = local_3;
    return _e33;
}

uint vol_in_object_word(uint solid) {
    return (VOL_IN_AT_OBJECTS + (VOL_IN_OBJECT_WORDS * solid));
}

bool vol_in_contains(vec3 lo_1, vec3 hi_1, vec3 point_2) {
    return (all(lessThanEqual(lo_1, point_2)) && all(lessThanEqual(point_2, hi_1)));
}

void vol_in_find_sides(inout float sides[1]) {
    uint solid_1 = 0u;
    uint solid_2 = VOL_IN_OBJECT_COUNT;
    bool loop_init_3 = true;
    while(true) {
        if (!loop_init_3) {
            uint _e47 = solid_1;
            solid_1 = (_e47 + 1u);
        }
        loop_init_3 = false;
        uint _e3 = solid_1;
        if ((_e3 < VOL_IN_OBJECT_COUNT)) {
        } else {
            break;
        }
        {
            uint _e6 = solid_1;
            uint _e7 = vol_in_object_word(_e6);
            vec3 _e9 = vol_in_word3_(VOL_IN_AT_EYE);
            uint _e10 = solid_1;
            sides[_e10] = 1.0;
            vec3 _e15 = vol_in_word3_((_e7 + 1u));
            vec3 _e18 = vol_in_word3_((_e7 + 4u));
            bool _e19 = vol_in_contains(_e15, _e18, _e9);
            float _e20 = vol_frame_word(_e7);
            if ((_e19 && (_e20 != 0.0))) {
                uint _e24 = solid_1;
                uint _e26 = solid_1;
                float _e27 = vol_in_object_distance(_e26, _e9);
                sides[_e24] = ((_e27 < 0.0) ? -1.0 : 1.0);
            }
            uint _e33 = solid_1;
            bool _e34 = vol_in_joins_the_one_before(_e33);
            if (_e34) {
                uint _e35 = solid_1;
                uint _e37 = solid_1;
                float _e39 = sides[_e37];
                uint _e40 = solid_1;
                float _e44 = sides[(_e40 - 1u)];
                sides[_e35] = min(_e39, _e44);
            }
        }
    }
    bool loop_init_4 = true;
    while(true) {
        if (!loop_init_4) {
            uint _e74 = solid_2;
            solid_2 = (_e74 - 1u);
        }
        loop_init_4 = false;
        uint _e51 = solid_2;
        if ((_e51 > 1u)) {
        } else {
            break;
        }
        {
            uint _e54 = solid_2;
            bool _e57 = vol_in_joins_the_one_before((_e54 - 1u));
            if (_e57) {
                uint _e58 = solid_2;
                uint _e62 = solid_2;
                float _e66 = sides[(_e62 - 2u)];
                uint _e67 = solid_2;
                float _e71 = sides[(_e67 - 1u)];
                sides[(_e58 - 2u)] = min(_e66, _e71);
            }
        }
    }
    return;
}

Vol_in_Span vol_in_loosened(Vol_in_Span span) {
    return Vol_in_Span((span.entry - (1.9073486e-6 * span.entry)), (span.leave + (1.9073486e-6 * span.leave)));
}

Vol_in_Span vol_in_slab(Vol_in_Ray ray, vec3 lo_2, vec3 hi_2) {
    Vol_in_Span span_1 = Vol_in_Span(0.0, 4000000.0);
    uint axis_1 = 0u;
    bool loop_init_5 = true;
    while(true) {
        if (!loop_init_5) {
            uint _e57 = axis_1;
            axis_1 = (_e57 + 1u);
        }
        loop_init_5 = false;
        uint _e9 = axis_1;
        if ((_e9 < 3u)) {
        } else {
            break;
        }
        {
            uint _e13 = axis_1;
            float o = ray.origin[_e13];
            uint _e16 = axis_1;
            float d = ray.direction[_e16];
            bool parallel = (abs(d) < VOL_IN_PARALLEL);
            float divisor = (parallel ? 1.0 : d);
            uint _e23 = axis_1;
            float a_8 = ((lo_2[_e23] - o) / divisor);
            uint _e27 = axis_1;
            float b_7 = ((hi_2[_e27] - o) / divisor);
            uint _e31 = axis_1;
            uint _e34 = axis_1;
            bool beside = ((o < lo_2[_e31]) || (o > hi_2[_e34]));
            float near_6 = (parallel ? (beside ? VOL_IN_FAR : 0.0) : min(a_8, b_7));
            float end_10 = (parallel ? (beside ? -4000000.0 : VOL_IN_FAR) : max(a_8, b_7));
            float _e50 = span_1.entry;
            span_1.entry = max(_e50, near_6);
            float _e54 = span_1.leave;
            span_1.leave = min(_e54, end_10);
        }
    }
    Vol_in_Span _e59 = span_1;
    return _e59;
}

void vol_in_object_spans(Vol_in_Ray ray_1, inout float sides_1[1], inout Vol_in_Span spans[1]) {
    uint solid_3 = 0u;
    bool loop_init_6 = true;
    while(true) {
        if (!loop_init_6) {
            uint _e45 = solid_3;
            solid_3 = (_e45 + 1u);
        }
        loop_init_6 = false;
        uint _e5 = solid_3;
        if ((_e5 < VOL_IN_OBJECT_COUNT)) {
        } else {
            break;
        }
        {
            uint _e8 = solid_3;
            uint _e9 = vol_in_object_word(_e8);
            vec3 _e12 = vol_in_word3_((_e9 + 1u));
            vec3 _e15 = vol_in_word3_((_e9 + 4u));
            Vol_in_Span _e16 = vol_in_slab(ray_1, _e12, _e15);
            Vol_in_Span _e17 = vol_in_loosened(_e16);
            float _e18 = vol_frame_word(_e9);
            bool there = (_e18 != 0.0);
            uint _e21 = solid_3;
            spans[_e21].entry = (there ? _e17.entry : VOL_IN_FAR);
            uint _e27 = solid_3;
            float _e29 = sides_1[_e27];
            bool is_within = ((_e29 < 0.0) && (_e17.entry <= _e17.leave));
            float leave = (is_within ? VOL_IN_FAR : _e17.leave);
            uint _e39 = solid_3;
            spans[_e39].leave = (there ? leave : -4000000.0);
        }
    }
    return;
}

vec3 vol_in_ray_at(Vol_in_Ray ray_2, float t_13) {
    return (ray_2.origin + (ray_2.direction * t_13));
}

float vol_in_reach(float last, float value) {
    float outside = max(value, 0.0);
    return ((last > 0.0) ? min(outside, (2.0 * last)) : outside);
}

float vol_in_remoteness() {
    vec3 _e1 = vol_in_word3_(VOL_IN_AT_EYE);
    float _e2 = vol_in_length3_(_e1);
    return _e2;
}

float vol_in_way_steepness(uint solid_4, Vol_in_Ray ray_3, float t_14, float ahead) {
    vec3 _e4 = vol_in_ray_at(ray_3, t_14);
    vec3 _e6 = vol_in_ray_at(ray_3, (t_14 + ahead));
    float _e8 = vol_in_remoteness();
    float slack_1 = (4.7683716e-7 * (_e8 + (t_14 + ahead)));
    float _e18 = vol_in_object_steepness(solid_4, (min(_e4, _e6) - vec3(slack_1)), (max(_e4, _e6) + vec3(slack_1)));
    return _e18;
}

float vol_in_shorten(uint solid_5, Vol_in_Ray ray_4, float t_15, float last_1, float value_1) {
    float ahead_1 = 0.0;
    uint count = 0u;
    uint _e5 = vol_in_object_word(solid_5);
    float _e8 = vol_frame_word((_e5 + 7u));
    if ((_e8 != VOL_IN_BY_STEEPNESS)) {
        return (_e8 * value_1);
    }
    if (!((value_1 > 0.0))) {
        return value_1;
    }
    float _e15 = vol_in_reach(last_1, value_1);
    ahead_1 = _e15;
    bool loop_init_7 = true;
    while(true) {
        if (!loop_init_7) {
            uint _e33 = count;
            count = (_e33 + 1u);
        }
        loop_init_7 = false;
        uint _e19 = count;
        if ((_e19 < VOL_IN_TRIES)) {
        } else {
            break;
        }
        {
            float _e22 = ahead_1;
            float _e23 = vol_in_way_steepness(solid_5, ray_4, t_15, _e22);
            if ((_e23 < VOL_IN_NO_BOUND)) {
                float _e27 = ahead_1;
                return min((value_1 / _e23), _e27);
            }
            float _e29 = ahead_1;
            ahead_1 = (0.25 * _e29);
        }
    }
    return 0.0;
}

Vol_in_Near vol_in_nearest(Vol_in_Ray ray_5, inout Vol_in_Span spans_1[1], inout float sides_2[1], float t_16, float before_1) {
    Vol_in_Near near = Vol_in_Near(4000000.0, 4000000.0, 0u, 4000000.0, 0.0, 4000000.0, 4000000.0);
    Vol_in_Near others = Vol_in_Near(0.0, 0.0, 0u, 0.0, 0.0, 0.0, 0.0);
    float farthest = -4000000.0;
    uint solid_6 = 0u;
    Vol_in_Near _e14 = near;
    others = _e14;
    bool loop_init_8 = true;
    while(true) {
        if (!loop_init_8) {
            uint _e117 = solid_6;
            solid_6 = (_e117 + 1u);
        }
        loop_init_8 = false;
        uint _e20 = solid_6;
        if ((_e20 < VOL_IN_OBJECT_COUNT)) {
        } else {
            break;
        }
        {
            uint _e23 = solid_6;
            bool _e24 = vol_in_joins_the_one_before(_e23);
            uint _e25 = solid_6;
            float _e27 = sides_2[_e25];
            bool joined_1 = (_e24 && (_e27 < 0.0));
            if (!(joined_1)) {
                Vol_in_Near _e32 = near;
                others = _e32;
                farthest = -4000000.0;
            }
            uint _e34 = solid_6;
            Vol_in_Span span_2 = spans_1[_e34];
            bool some_2 = (span_2.entry <= span_2.leave);
            bool ahead_5 = (some_2 && (t_16 < span_2.entry));
            float _e45 = near.gap;
            float _e47 = near.gap;
            near.gap = (ahead_5 ? min(_e47, (span_2.entry - t_16)) : _e45);
            float _e54 = near.entry;
            float _e56 = near.entry;
            near.entry = (ahead_5 ? min(_e56, span_2.entry) : _e54);
            if (((some_2 && (t_16 >= span_2.entry)) && (t_16 <= span_2.leave))) {
                float _e68 = near.rest;
                near.rest = max(_e68, (span_2.leave - t_16));
                uint _e72 = solid_6;
                uint _e73 = vol_in_object_word(_e72);
                float _e76 = vol_frame_word((_e73 + 7u));
                bool is_ball = (_e76 != VOL_IN_BY_STEEPNESS);
                float _e81 = near.leave;
                near.leave = min(_e81, (is_ball ? span_2.leave : 0.0));
                uint _e86 = solid_6;
                float _e88 = sides_2[_e86];
                uint _e89 = solid_6;
                vec3 _e90 = vol_in_ray_at(ray_5, t_16);
                float _e91 = vol_in_object_distance(_e89, _e90);
                float seen_3 = (_e88 * _e91);
                uint _e93 = solid_6;
                float _e95 = vol_in_shorten(_e93, ray_5, t_16, (t_16 - before_1), seen_3);
                float _e97 = farthest;
                if ((!(joined_1) || (seen_3 > _e97))) {
                    farthest = seen_3;
                    float _e102 = others.value;
                    near.value = min(_e102, seen_3);
                    float _e105 = others.distance_;
                    bool closer = (_e95 < _e105);
                    float _e109 = others.distance_;
                    near.distance_ = (closer ? _e95 : _e109);
                    uint _e113 = others.solid;
                    uint _e114 = solid_6;
                    near.solid = (closer ? _e114 : _e113);
                }
            }
        }
    }
    Vol_in_Near _e119 = near;
    return _e119;
}

bool vol_in_is_past(Vol_in_Near near_1, Vol_in_Walker walker) {
    return (walker.guessed && ((walker.free + near_1.distance_) < (walker.t - walker.before)));
}

Vol_in_Walker vol_in_back(Vol_in_Walker walker_1) {
    return Vol_in_Walker((walker_1.before + walker_1.free), walker_1.before, walker_1.free, false);
}

float vol_in_footprint() {
    vec3 _e1 = vol_in_word3_(VOL_IN_AT_UP);
    float _e2 = vol_in_length3_(_e1);
    float _e6 = vol_frame_word(5u);
    return ((2.0 * _e2) / _e6);
}

float vol_in_tolerance(float t_17) {
    float _e1 = vol_in_footprint();
    float pixel_3 = ((0.5 * _e1) * t_17);
    float _e6 = vol_in_remoteness();
    return max(pixel_3, (4.7683716e-7 * (_e6 + t_17)));
}

bool vol_in_is_stuck(uint step_) {
    return (step_ > 1000u);
}

float vol_in_advance(Vol_in_Near near_2, uint step_1, float least) {
    float free = min(near_2.distance_, near_2.gap);
    float left = float(((VOL_IN_MAX_STEPS - step_1) + 1u));
    bool _e15 = vol_in_is_stuck(step_1);
    float even = (_e15 ? min((near_2.rest / left), near_2.gap) : 0.0);
    return max(max(free, least), even);
}

Vol_in_Walker vol_in_onward(Vol_in_Near near_3, Vol_in_Walker walker_2, uint step_2, float least_1) {
    float _e4 = vol_in_advance(near_3, step_2, least_1);
    float last_5 = (walker_2.t - walker_2.before);
    bool is_first = (last_5 <= 0.0);
    float fall = max(((walker_2.free - near_3.distance_) / (is_first ? 1.0 : last_5)), 0.0);
    float touching = ((VOL_IN_EAGERNESS * near_3.distance_) / (1.0 + fall));
    float guess = min(min(touching, (VOL_IN_ROOM * near_3.gap)), (VOL_IN_ROOM * (near_3.leave - walker_2.t)));
    float place_6 = (walker_2.t + guess);
    bool is_inside = ((place_6 < near_3.entry) && (place_6 <= near_3.leave));
    bool _e45 = vol_in_is_stuck(step_2);
    bool guessed = ((((guess > _e4) && is_inside) && !(is_first)) && !(_e45));
    return Vol_in_Walker((guessed ? place_6 : (walker_2.t + _e4)), walker_2.t, _e4, guessed);
}

float vol_in_stride(float t_18) {
    float _e1 = vol_in_footprint();
    float pixel_4 = ((0.025 * _e1) * t_18);
    float _e6 = vol_in_remoteness();
    return max(pixel_4, (4.7683716e-7 * (_e6 + t_18)));
}

float vol_in_probe(Vol_in_Bracket bracket) {
    bool is_proper = ((bracket.outside.y >= 0.0) && (bracket.inside.y < 0.0));
    float fall_1 = (is_proper ? (bracket.outside.y - bracket.inside.y) : 1.0);
    float part_3 = (bracket.outside.y / fall_1);
    float between = (bracket.outside.x + ((bracket.inside.x - bracket.outside.x) * part_3));
    return (is_proper ? between : bracket.inside.x);
}

Vol_in_Bracket vol_in_narrow(Vol_in_Bracket bracket_1, vec2 found) {
    bool within = (found.y < 0.0);
    return Vol_in_Bracket((within ? bracket_1.outside : found), (within ? found : bracket_1.inside));
}

float vol_in_rounding(float t_19) {
    float _e2 = vol_in_remoteness();
    return (7.6293945e-6 * (_e2 + t_19));
}

vec3 vol_in_facing_gradient(Vol_in_Ray ray_6, uint solid_7, float t_20, float side) {
    vec3 gradient = vec3(0.0);
    float aside = 0.0;
    uint round_ = 0u;
    float _e7 = vol_in_rounding(t_20);
    aside = _e7;
    bool loop_init_9 = true;
    while(true) {
        if (!loop_init_9) {
            uint _e28 = round_;
            round_ = (_e28 + 1u);
        }
        loop_init_9 = false;
        uint _e11 = round_;
        if ((_e11 < 2u)) {
        } else {
            break;
        }
        {
            float _e14 = aside;
            vec3 _e16 = vol_in_ray_at(ray_6, (t_20 + _e14));
            vec3 _e17 = vol_in_object_gradient(solid_7, _e16);
            gradient = (_e17 * side);
            vec3 _e19 = gradient;
            float _e21 = vol_in_dot3_(_e19, ray_6.direction);
            if (!((_e21 > 0.0))) {
                break;
            }
            float _e25 = aside;
            aside = -(_e25);
        }
    }
    vec3 _e30 = gradient;
    return _e30;
}

Vol_in_Contact vol_in_contact(Vol_in_Ray ray_7, uint solid_8, float t_21, float value_2, vec3 gradient_1) {
    float _e5 = vol_in_length3_(gradient_1);
    bool is_flat_1 = (_e5 < VOL_IN_FLAT);
    float divisor_1 = (is_flat_1 ? 1.0 : _e5);
    vec3 normal = (is_flat_1 ? -(ray_7.direction) : (gradient_1 / vec3(divisor_1)));
    float _e15 = vol_in_tolerance(t_21);
    float most = (4.0 * _e15);
    vec3 _e19 = vol_in_ray_at(ray_7, t_21);
    return Vol_in_Contact(true, solid_8, t_21, _e19, normal, min((value_2 / divisor_1), most));
}

Vol_in_Contact vol_in_refine(Vol_in_Ray ray_8, uint solid_9, float before_2, float t_22, float side_1) {
    Vol_in_Bracket bracket_2 = Vol_in_Bracket(vec2(0.0), vec2(0.0));
    uint round_1 = 0u;
    bracket_2 = Vol_in_Bracket(vec2(before_2, 0.0), vec2(t_22, 0.0));
    bool loop_init_10 = true;
    while(true) {
        if (!loop_init_10) {
            uint _e41 = round_1;
            round_1 = (_e41 + 1u);
        }
        loop_init_10 = false;
        uint _e13 = round_1;
        if ((_e13 < 6u)) {
        } else {
            break;
        }
        {
            Vol_in_Bracket _e16 = bracket_2;
            float _e17 = vol_in_probe(_e16);
            uint _e18 = round_1;
            uint _e22 = round_1;
            float place_7 = ((_e22 == 0u) ? before_2 : ((_e18 == 1u) ? t_22 : _e17));
            vec3 _e26 = vol_in_ray_at(ray_8, place_7);
            float _e27 = vol_in_object_distance(solid_9, _e26);
            vec2 found_1 = vec2(place_7, (side_1 * _e27));
            uint _e30 = round_1;
            if ((_e30 == 0u)) {
                bracket_2.outside = found_1;
            } else {
                uint _e34 = round_1;
                if ((_e34 == 1u)) {
                    bracket_2.inside = found_1;
                } else {
                    Vol_in_Bracket _e38 = bracket_2;
                    Vol_in_Bracket _e39 = vol_in_narrow(_e38, found_1);
                    bracket_2 = _e39;
                }
            }
        }
    }
    float _e45 = bracket_2.outside.y;
    float _e49 = bracket_2.inside.y;
    bool nearer = (abs(_e45) < abs(_e49));
    vec2 _e53 = bracket_2.inside;
    vec2 _e55 = bracket_2.outside;
    vec2 best = (nearer ? _e55 : _e53);
    vec3 _e58 = vol_in_facing_gradient(ray_8, solid_9, best.x, side_1);
    Vol_in_Contact _e62 = vol_in_contact(ray_8, solid_9, best.x, abs(best.y), _e58);
    return _e62;
}

Vol_in_Contact vol_in_trace(Vol_in_Ray ray_9) {
    float sides_3[1] = float[1](0.0);
    Vol_in_Span spans_2[1] = Vol_in_Span[1](Vol_in_Span(0.0, 0.0));
    Vol_in_Walker walker_3 = Vol_in_Walker(0.0, 0.0, 0.0, false);
    bool hit = false;
    uint solid_10 = 0u;
    uint count_1 = 1u;
    vol_in_find_sides(sides_3);
    vol_in_object_spans(ray_9, sides_3, spans_2);
    bool loop_init_11 = true;
    while(true) {
        if (!loop_init_11) {
            uint _e50 = count_1;
            count_1 = (_e50 + 1u);
        }
        loop_init_11 = false;
        uint _e15 = count_1;
        if ((_e15 <= VOL_IN_MAX_STEPS)) {
        } else {
            break;
        }
        {
            float _e19 = walker_3.t;
            float _e21 = walker_3.before;
            Vol_in_Near _e22 = vol_in_nearest(ray_9, spans_2, sides_3, _e19, _e21);
            Vol_in_Walker _e23 = walker_3;
            bool _e24 = vol_in_is_past(_e22, _e23);
            if (_e24) {
                Vol_in_Walker _e25 = walker_3;
                Vol_in_Walker _e26 = vol_in_back(_e25);
                walker_3 = _e26;
                continue;
            }
            float _e29 = walker_3.t;
            float _e30 = vol_in_tolerance(_e29);
            uint _e31 = count_1;
            hit = (_e22.value < ((_e31 == VOL_IN_MAX_STEPS) ? _e30 : 0.0));
            solid_10 = _e22.solid;
            Vol_in_Walker _e38 = walker_3;
            uint _e39 = count_1;
            float _e41 = walker_3.t;
            float _e42 = vol_in_stride(_e41);
            Vol_in_Walker _e43 = vol_in_onward(_e22, _e38, _e39, _e42);
            bool _e44 = hit;
            if ((_e44 || (_e43.t >= VOL_IN_FAR))) {
                break;
            }
            walker_3 = _e43;
        }
    }
    bool _e52 = hit;
    if (_e52) {
        uint _e53 = solid_10;
        float _e55 = walker_3.before;
        float _e57 = walker_3.t;
        uint _e58 = solid_10;
        float _e60 = sides_3[_e58];
        Vol_in_Contact _e61 = vol_in_refine(ray_9, _e53, _e55, _e57, _e60);
        return _e61;
    }
    return Vol_in_Contact(false, 0u, 4000000.0, vec3(0.0), vec3(0.0), 0.0);
}

uint vol_in_light_count() {
    float _e1 = vol_frame_word(VOL_IN_AT_LIGHT_COUNT);
    return uint(_e1);
}

Vol_in_Arriving vol_in_arriving(uint light, vec3 point_3) {
    uint at_2 = (VOL_IN_AT_LIGHTS + (VOL_IN_LIGHT_WORDS * light));
    float _e6 = vol_frame_word(at_2);
    bool distant = (_e6 != 0.0);
    vec3 _e11 = vol_in_word3_((at_2 + 1u));
    vec3 toward_2 = (_e11 - point_3);
    float _e13 = vol_in_dot3_(toward_2, toward_2);
    float squared = max(_e13, 1e-12);
    float distance_11 = sqrt(squared);
    vec3 _e21 = vol_in_word3_((at_2 + 1u));
    vec3 direction_5 = (distant ? _e21 : (toward_2 / vec3(distance_11)));
    vec3 _e25 = vol_in_word3_((at_2 + 4u));
    vec3 _e30 = vol_in_word3_((at_2 + 4u));
    vec3 irradiance = (distant ? _e30 : (_e25 / vec3(squared)));
    float _e34 = vol_frame_word((at_2 + 7u));
    bool shadows = (_e34 != 0.0);
    float _e39 = vol_frame_word((at_2 + 8u));
    float slope_11 = (distant ? _e39 : min((_e39 / distance_11), VOL_IN_MAX_SPREAD_TANGENT));
    float _e46 = vol_frame_word((at_2 + 10u));
    uint grid_4 = uint(_e46);
    float _e50 = vol_frame_word((at_2 + 11u));
    uint style = uint(_e50);
    return Vol_in_Arriving(direction_5, (distant ? VOL_IN_FAR : distance_11), irradiance, shadows, slope_11, grid_4, style);
}

float vol_in_shadow_bias(float t_23) {
    float _e1 = vol_in_footprint();
    float pixel_5 = ((0.1 * _e1) * t_23);
    float _e5 = vol_in_rounding(t_23);
    return (pixel_5 + _e5);
}

Vol_in_Ray vol_in_new_ray(vec3 origin, vec3 direction) {
    return Vol_in_Ray(origin, direction, 0.0);
}

Vol_in_Ray vol_in_rim(Vol_in_Ray ray_10, float slope, vec2 end) {
    vec3 d_1 = ray_10.direction;
    float turn_1 = ((d_1.z < 0.0) ? -1.0 : 1.0);
    float a_9 = (-1.0 / (turn_1 + d_1.z));
    float b_8 = ((d_1.x * d_1.y) * a_9);
    vec3 right = vec3((1.0 + (turn_1 * ((d_1.x * d_1.x) * a_9))), (turn_1 * b_8), -((turn_1 * d_1.x)));
    vec3 up = vec3(b_8, (turn_1 + ((d_1.y * d_1.y) * a_9)), -(d_1.y));
    vec3 toward_3 = (d_1 + (((right * end.x) + (up * end.y)) * slope));
    float _e46 = vol_in_length3_(toward_3);
    Vol_in_Ray _e49 = vol_in_new_ray(ray_10.origin, (toward_3 / vec3(_e46)));
    return _e49;
}

float vol_in_squared_sine(float tangent) {
    float squared_1 = (tangent * tangent);
    return (squared_1 / (1.0 + squared_1));
}

void vol_in_cone_spans(Vol_in_Ray ray_11, float distance_, float slope_1, inout Vol_in_Span spans_3[1]) {
    uint solid_11 = 0u;
    bool loop_init_12 = true;
    while(true) {
        if (!loop_init_12) {
            uint _e51 = solid_11;
            solid_11 = (_e51 + 1u);
        }
        loop_init_12 = false;
        uint _e6 = solid_11;
        if ((_e6 < VOL_IN_OBJECT_COUNT)) {
        } else {
            break;
        }
        {
            uint _e9 = solid_11;
            uint _e10 = vol_in_object_word(_e9);
            vec3 _e13 = vol_in_word3_((_e10 + 1u));
            vec3 _e16 = vol_in_word3_((_e10 + 4u));
            float _e24 = vol_in_length3_(max(abs((_e13 - ray_11.origin)), abs((_e16 - ray_11.origin))));
            float width = ((VOL_IN_CLEAR * slope_1) * min(_e24, distance_));
            Vol_in_Span _e33 = vol_in_slab(ray_11, (_e13 - vec3(width)), (_e16 + vec3(width)));
            Vol_in_Span _e34 = vol_in_loosened(_e33);
            float _e35 = vol_frame_word(_e10);
            bool there_1 = (_e35 != 0.0);
            uint _e38 = solid_11;
            spans_3[_e38].entry = (there_1 ? _e34.entry : VOL_IN_FAR);
            uint _e44 = solid_11;
            spans_3[_e44].leave = (there_1 ? _e34.leave : -4000000.0);
        }
    }
    return;
}

Vol_in_Around vol_in_around(Vol_in_Ray ray_12, inout Vol_in_Span spans_4[1], float t_24) {
    Vol_in_Around near_4 = Vol_in_Around(4000000.0, 4000000.0, 4000000.0);
    uint solid_12 = 0u;
    bool loop_init_13 = true;
    while(true) {
        if (!loop_init_13) {
            uint _e60 = solid_12;
            solid_12 = (_e60 + 1u);
        }
        loop_init_13 = false;
        uint _e10 = solid_12;
        if ((_e10 < VOL_IN_OBJECT_COUNT)) {
        } else {
            break;
        }
        {
            uint _e13 = solid_12;
            Vol_in_Span span_3 = spans_4[_e13];
            bool some_3 = (span_3.entry <= span_3.leave);
            bool before_8 = (some_3 && (t_24 < span_3.entry));
            float _e24 = near_4.gap;
            float _e26 = near_4.gap;
            near_4.gap = (before_8 ? min(_e26, (span_3.entry - t_24)) : _e24);
            if (((some_3 && (t_24 >= span_3.entry)) && (t_24 <= span_3.leave))) {
                uint _e37 = solid_12;
                vec3 _e38 = vol_in_ray_at(ray_12, t_24);
                float _e39 = vol_in_object_distance(_e37, _e38);
                uint _e40 = solid_12;
                float _e42 = vol_in_shorten(_e40, ray_12, t_24, 0.0, _e39);
                uint _e43 = solid_12;
                uint _e44 = vol_in_object_word(_e43);
                float _e47 = vol_frame_word((_e44 + 7u));
                bool own_units = (_e47 == VOL_IN_BY_STEEPNESS);
                float _e52 = near_4.distance_;
                near_4.distance_ = min(_e52, (own_units ? _e42 : _e39));
                float _e57 = near_4.safe;
                near_4.safe = min(_e57, _e42);
            }
        }
    }
    Vol_in_Around _e62 = near_4;
    return _e62;
}

bool vol_in_enters(float distance_1, float t_25, float least_2) {
    float start = ((8.0 * least_2) - t_25);
    return (distance_1 < -(max(start, 0.0)));
}

float vol_in_least(vec2 a_6, vec2 b_6, vec2 c_3) {
    bool in_order = ((a_6.x > b_6.x) && (b_6.x > c_3.x));
    bool lowest_2 = ((b_6.y <= a_6.y) && (b_6.y <= c_3.y));
    if (!((in_order && lowest_2))) {
        return c_3.y;
    }
    float fall_2 = ((b_6.y - a_6.y) / (b_6.x - a_6.x));
    float rise_2 = ((c_3.y - b_6.y) / (c_3.x - b_6.x));
    float bend = ((rise_2 - fall_2) / (c_3.x - a_6.x));
    if ((bend <= 0.0)) {
        return b_6.y;
    }
    float place_8 = ((0.5 * (a_6.x + b_6.x)) - (0.5 * (fall_2 / bend)));
    float value_5 = (a_6.y + ((place_8 - a_6.x) * (fall_2 + (bend * (place_8 - b_6.x)))));
    return min(max(value_5, (0.75 * b_6.y)), b_6.y);
}

float vol_in_cone_step(Vol_in_Around near_5, float least_step, float slope_2, float t_26) {
    float _e6 = vol_in_squared_sine((VOL_IN_CLEAR * slope_2));
    float sine = sqrt(_e6);
    float free_1 = ((near_5.safe - (sine * t_26)) / (1.0 + sine));
    float shortest = max(least_step, ((0.002 * slope_2) * t_26));
    return max(min(max(free_1, (0.5 * near_5.safe)), near_5.gap), shortest);
}

float vol_in_clearance(float lowest, float slope_3) {
    float cosine_1 = max((1.0 - lowest), VOL_IN_EPSILON);
    return min((sqrt((lowest / cosine_1)) / slope_3), VOL_IN_CLEAR);
}

float vol_in_walk(Vol_in_Ray ray_13, float distance_2, float least_step_1, float slope_4) {
    float lowest_1 = 0.0;
    Vol_in_Span spans_5[1] = Vol_in_Span[1](Vol_in_Span(0.0, 0.0));
    float t_27 = 0.0;
    vec2 older = vec2(0.0);
    vec2 newer = vec2(0.0);
    uint count_2 = 0u;
    float _e6 = vol_in_squared_sine((VOL_IN_CLEAR * slope_4));
    lowest_1 = _e6;
    vol_in_cone_spans(ray_13, distance_2, slope_4, spans_5);
    float end_11 = min(distance_2, VOL_IN_FAR);
    bool loop_init_14 = true;
    while(true) {
        if (!loop_init_14) {
            uint _e76 = count_2;
            count_2 = (_e76 + 1u);
        }
        loop_init_14 = false;
        uint _e21 = count_2;
        if ((_e21 < VOL_IN_MAX_STEPS)) {
        } else {
            break;
        }
        {
            float _e24 = t_27;
            Vol_in_Around _e25 = vol_in_around(ray_13, spans_5, _e24);
            float _e27 = t_27;
            bool _e28 = vol_in_enters(_e25.distance_, _e27, least_step_1);
            if (_e28) {
                lowest_1 = 0.0;
                break;
            }
            float _e30 = t_27;
            float _e38 = t_27;
            bool counts = (((_e30 > 0.0) && (_e25.distance_ >= 0.0)) && (_e25.distance_ < (end_11 - _e38)));
            float _e42 = t_27;
            float divisor_2 = (counts ? _e42 : 1.0);
            float sine_1 = min((_e25.distance_ / divisor_2), 1.0);
            vec2 sample_1 = vec2((1.0 / divisor_2), (sine_1 * sine_1));
            vec2 _e54 = older;
            vec2 _e55 = newer;
            float _e56 = vol_in_least(_e54, _e55, sample_1);
            float found_2 = min(sample_1.y, _e56);
            float _e58 = lowest_1;
            float _e59 = lowest_1;
            lowest_1 = (counts ? min(_e59, found_2) : _e58);
            vec2 _e64 = newer;
            older = (counts ? _e64 : vec2(0.0));
            newer = (counts ? sample_1 : vec2(0.0));
            float _e69 = t_27;
            float _e70 = t_27;
            float _e71 = vol_in_cone_step(_e25, least_step_1, slope_4, _e70);
            t_27 = (_e69 + _e71);
            float _e73 = t_27;
            if ((_e73 >= end_11)) {
                break;
            }
        }
    }
    float _e78 = lowest_1;
    float _e79 = vol_in_clearance(_e78, slope_4);
    return _e79;
}

float vol_in_clear_depth(float clear, vec2 end_1, vec2 place_1) {
    vec2 aside_1 = (place_1 - end_1);
    float distance_12 = sqrt(((aside_1.x * aside_1.x) + (aside_1.y * aside_1.y)));
    return ((clear > 0.0) ? (clear - distance_12) : -2.0);
}

float vol_in_lit_part(float centre, inout float clear_1[8]) {
    vec2 ends[8] = VOL_IN_RIM;
    vec2 places[19] = VOL_IN_PLACES;
    float sum_3 = 0.0;
    uint index_15 = 0u;
    float inside = 0.0;
    uint end_2 = 0u;
    float widest = 0.0;
    uint end_3 = 0u;
    bool loop_init_15 = true;
    while(true) {
        if (!loop_init_15) {
            uint _e60 = index_15;
            index_15 = (_e60 + 1u);
        }
        loop_init_15 = false;
        uint _e10 = index_15;
        if ((_e10 < VOL_IN_PLACE_COUNT)) {
        } else {
            break;
        }
        {
            uint _e15 = index_15;
            vec2 _e17 = places[_e15];
            float _e18 = vol_in_clear_depth(centre, vec2(0.0), _e17);
            inside = _e18;
            end_2 = 0u;
            bool loop_init_16 = true;
            while(true) {
                if (!loop_init_16) {
                    uint _e38 = end_2;
                    end_2 = (_e38 + 1u);
                }
                loop_init_16 = false;
                uint _e22 = end_2;
                if ((_e22 < VOL_IN_RIM_COUNT)) {
                } else {
                    break;
                }
                {
                    float _e25 = inside;
                    uint _e26 = end_2;
                    float _e28 = clear_1[_e26];
                    uint _e29 = end_2;
                    vec2 _e31 = ends[_e29];
                    uint _e32 = index_15;
                    vec2 _e34 = places[_e32];
                    float _e35 = vol_in_clear_depth(_e28, _e31, _e34);
                    inside = max(_e25, _e35);
                }
            }
            float _e40 = inside;
            float edge = min(max(((_e40 + VOL_IN_LACK) / VOL_IN_BLUR), -1.0), 1.0);
            float over = (1.0 + edge);
            float _e51 = sum_3;
            sum_3 = (_e51 + ((0.25 * (over * over)) * (2.0 - edge)));
        }
    }
    float _e62 = sum_3;
    float part_4 = (_e62 / 19.0);
    float whole_1 = max(((4.0 * centre) - 3.0), 0.0);
    widest = centre;
    bool loop_init_17 = true;
    while(true) {
        if (!loop_init_17) {
            uint _e83 = end_3;
            end_3 = (_e83 + 1u);
        }
        loop_init_17 = false;
        uint _e74 = end_3;
        if ((_e74 < VOL_IN_RIM_COUNT)) {
        } else {
            break;
        }
        {
            float _e77 = widest;
            uint _e78 = end_3;
            float _e80 = clear_1[_e78];
            widest = max(_e77, _e80);
        }
    }
    float _e90 = widest;
    return ((part_4 + ((1.0 - part_4) * (whole_1 * whole_1))) * min((10.0 * _e90), 1.0));
}

float vol_in_lit_part_of(Vol_in_Ray ray_14, float distance_3, float least_step_2, float slope_5) {
    vec2 ends_1[8] = VOL_IN_RIM;
    float clear_2[8] = float[8](0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0);
    float centre_1 = 0.0;
    uint index_16 = 0u;
    Vol_in_Ray toward = Vol_in_Ray(vec3(0.0), vec3(0.0), 0.0);
    bool loop_init_18 = true;
    while(true) {
        if (!loop_init_18) {
            uint _e36 = index_16;
            index_16 = (_e36 + 1u);
        }
        loop_init_18 = false;
        uint _e11 = index_16;
        if ((_e11 <= VOL_IN_RIM_COUNT)) {
        } else {
            break;
        }
        {
            uint _e14 = index_16;
            uint end_12 = (max(_e14, 1u) - 1u);
            toward = ray_14;
            uint _e20 = index_16;
            if ((_e20 > 0u)) {
                vec2 _e24 = ends_1[end_12];
                Vol_in_Ray _e25 = vol_in_rim(ray_14, slope_5, _e24);
                toward = _e25;
            }
            Vol_in_Ray _e26 = toward;
            float _e27 = vol_in_walk(_e26, distance_3, least_step_2, slope_5);
            uint _e28 = index_16;
            if ((_e28 > 0u)) {
                clear_2[end_12] = _e27;
            } else {
                if ((_e27 >= 1.0)) {
                    return 1.0;
                } else {
                    centre_1 = _e27;
                }
            }
        }
    }
    float _e38 = centre_1;
    float _e39 = vol_in_lit_part(_e38, clear_2);
    return _e39;
}

void vol_in_no_sides(inout float sides_4[1]) {
    uint solid_13 = 0u;
    bool loop_init_19 = true;
    while(true) {
        if (!loop_init_19) {
            uint _e10 = solid_13;
            solid_13 = (_e10 + 1u);
        }
        loop_init_19 = false;
        uint _e3 = solid_13;
        if ((_e3 < VOL_IN_OBJECT_COUNT)) {
        } else {
            break;
        }
        {
            uint _e6 = solid_13;
            sides_4[_e6] = 1.0;
        }
    }
    return;
}

bool vol_in_blocked(Vol_in_Ray ray_15, float distance_4, float least_3) {
    float sides_5[1] = float[1](0.0);
    Vol_in_Span spans_6[1] = Vol_in_Span[1](Vol_in_Span(0.0, 0.0));
    Vol_in_Walker walker_4 = Vol_in_Walker(0.0, 0.0, 0.0, false);
    bool inside_1 = false;
    uint count_3 = 1u;
    vol_in_no_sides(sides_5);
    vol_in_object_spans(ray_15, sides_5, spans_6);
    float end_13 = min(distance_4, VOL_IN_FAR);
    bool loop_init_20 = true;
    while(true) {
        if (!loop_init_20) {
            uint _e42 = count_3;
            count_3 = (_e42 + 1u);
        }
        loop_init_20 = false;
        uint _e17 = count_3;
        if ((_e17 <= VOL_IN_MAX_STEPS)) {
        } else {
            break;
        }
        {
            float _e21 = walker_4.t;
            float _e23 = walker_4.before;
            Vol_in_Near _e24 = vol_in_nearest(ray_15, spans_6, sides_5, _e21, _e23);
            Vol_in_Walker _e25 = walker_4;
            bool _e26 = vol_in_is_past(_e24, _e25);
            if (_e26) {
                Vol_in_Walker _e27 = walker_4;
                Vol_in_Walker _e28 = vol_in_back(_e27);
                walker_4 = _e28;
                continue;
            }
            float _e31 = walker_4.t;
            bool _e32 = vol_in_enters(_e24.distance_, _e31, least_3);
            inside_1 = _e32;
            Vol_in_Walker _e33 = walker_4;
            uint _e34 = count_3;
            Vol_in_Walker _e35 = vol_in_onward(_e24, _e33, _e34, least_3);
            walker_4 = _e35;
            bool _e36 = inside_1;
            float _e38 = walker_4.t;
            if ((_e36 || (_e38 >= end_13))) {
                break;
            }
        }
    }
    bool _e44 = inside_1;
    return _e44;
}

float vol_in_unblocked(Vol_in_Ray ray_16, float distance_5, float bias) {
    bool _e5 = vol_in_blocked(ray_16, distance_5, (0.25 * bias));
    return (_e5 ? 0.0 : 1.0);
}

Vol_in_Stencil vol_in_stencil(float place_2, float last_2, bool spline) {
    float index_22 = min(floor(place_2), (last_2 - 1.0));
    float t_34 = (place_2 - index_22);
    vec4 local_14 = vec4(((((1.0 - (0.5 * t_34)) * t_34) - 0.5) * t_34), (((((1.5 * t_34) - 2.5) * t_34) * t_34) + 1.0), ((((2.0 - (1.5 * t_34)) * t_34) + 0.5) * t_34), ((((0.5 * t_34) - 0.5) * t_34) * t_34));
    float back_3 = (1.0 - t_34);
    vec4 through = vec4((0.16666667 * (back_3 * (back_3 * back_3))), (0.6666667 - ((t_34 * t_34) * (1.0 - (0.5 * t_34)))), (0.6666667 - ((back_3 * back_3) * (1.0 - (0.5 * back_3)))), (0.16666667 * (t_34 * (t_34 * t_34))));
    vec4 weights_5 = (spline ? through : local_14);
    ivec4 around = (ivec4(int(index_22)) + ivec4(-1, 0, 1, 2));
    return Vol_in_Stencil(min(max(around, ivec4(0)), ivec4(int(last_2))), weights_5);
}

float vol_in_grid_channel(uint first, Vol_in_Stencil x_22, Vol_in_Stencil y_7, Vol_in_Stencil z_5, int columns, uint channel, uint channels) {
    vec4 sums = vec4(0.0);
    uint i_4 = 0u;
    uint j_3 = 0u;
    uint four = min((channels + 3u), 4u);
    bool loop_init_21 = true;
    while(true) {
        if (!loop_init_21) {
            uint _e82 = i_4;
            i_4 = (_e82 + 1u);
        }
        loop_init_21 = false;
        uint _e16 = i_4;
        if ((_e16 < four)) {
        } else {
            break;
        }
        {
            j_3 = 0u;
            bool loop_init_22 = true;
            while(true) {
                if (!loop_init_22) {
                    uint _e79 = j_3;
                    j_3 = (_e79 + 1u);
                }
                loop_init_22 = false;
                uint _e20 = j_3;
                if ((_e20 < four)) {
                } else {
                    break;
                }
                {
                    uint _e24 = i_4;
                    uint _e28 = j_3;
                    uint column = (first + (3u * uint(((x_22.at[_e24] * columns) + y_7.at[_e28]))));
                    float _e34 = vol_input_word(column);
                    int begin = int(_e34);
                    float _e38 = vol_input_word((column + 1u));
                    int more_1 = int(_e38);
                    float _e43 = vol_input_word((column + 2u));
                    uint depths = ((first + (4u * uint(_e43))) + channel);
                    uvec4 row = ((uvec4(min(max((z_5.at - ivec4(begin)), ivec4(0)), ivec4(more_1))) * channels) + uvec4(depths));
                    float _e60 = vol_input_word(row.x);
                    float _e62 = vol_input_word(row.y);
                    float _e64 = vol_input_word(row.z);
                    float _e66 = vol_input_word(row.w);
                    vec4 around_1 = vec4(_e60, _e62, _e64, _e66);
                    vec4 _e68 = sums;
                    uint _e70 = i_4;
                    uint _e73 = j_3;
                    sums = (_e68 + ((x_22.weights[_e70] * y_7.weights[_e73]) * around_1));
                }
            }
        }
    }
    vec4 _e85 = sums;
    vec4 weighted = (z_5.weights * _e85);
    return max((((weighted.x + weighted.y) + weighted.z) + weighted.w), 0.0);
}

vec3 vol_in_grid_depth(uint grid, vec3 point_4) {
    vec3 depth = vec3(0.0);
    uint channel_1 = 0u;
    vec3 _e4 = vol_in_word3_((grid + 1u));
    vec3 _e7 = vol_in_word3_((grid + 13u));
    vec3 _e10 = vol_in_word3_((grid + 16u));
    vec3 _e13 = vol_in_word3_((grid + 19u));
    float _e14 = vol_frame_word(grid);
    bool distant_1 = (_e14 != 0.0);
    vec3 off = (point_4 - _e4);
    vec3 _e20 = vol_in_word3_((grid + 4u));
    float _e21 = vol_in_dot3_(off, _e20);
    vec3 _e24 = vol_in_word3_((grid + 7u));
    float _e25 = vol_in_dot3_(off, _e24);
    vec3 _e28 = vol_in_word3_((grid + 10u));
    float _e29 = vol_in_dot3_(off, _e28);
    bool ahead_6 = (distant_1 || (_e29 > (0.5 * _e7.z)));
    float divisor_3 = ((ahead_6 && !(distant_1)) ? _e29 : 1.0);
    float _e41 = vol_in_length3_(off);
    vec3 seen_4 = vec3((_e21 / divisor_3), (_e25 / divisor_3), (distant_1 ? _e29 : _e41));
    vec3 last_6 = (_e13 - vec3(1.0));
    vec3 place_9 = ((seen_4 - _e7) * _e10);
    bool beside_1 = ((((place_9.x < 0.0) || (place_9.x > last_6.x)) || (place_9.y < 0.0)) || (place_9.y > last_6.y));
    if (((!(ahead_6) || beside_1) || (place_9.z <= 0.0))) {
        return vec3(0.0);
    }
    float _e74 = vol_frame_word((grid + 25u));
    uint channels_1 = uint(_e74);
    float _e78 = vol_frame_word((grid + 27u));
    bool spline_1 = (_e78 != 0.0);
    Vol_in_Stencil _e83 = vol_in_stencil(place_9.x, last_6.x, spline_1);
    Vol_in_Stencil _e86 = vol_in_stencil(place_9.y, last_6.y, spline_1);
    Vol_in_Stencil _e91 = vol_in_stencil(min(place_9.z, last_6.z), last_6.z, spline_1);
    float _e94 = vol_frame_word((grid + 26u));
    uint first_3 = uint(_e94);
    vec3 _e98 = vol_in_word3_((grid + 22u));
    bool loop_init_23 = true;
    while(true) {
        if (!loop_init_23) {
            uint _e113 = channel_1;
            channel_1 = (_e113 + 1u);
        }
        loop_init_23 = false;
        uint _e104 = channel_1;
        if ((_e104 < channels_1)) {
        } else {
            break;
        }
        {
            uint _e106 = channel_1;
            uint _e110 = channel_1;
            float _e111 = vol_in_grid_channel(first_3, _e83, _e86, _e91, int(_e13.y), _e110, channels_1);
            depth[_e106] = _e111;
        }
    }
    vec3 _e115 = depth;
    float _e117 = depth.x;
    return (_e98 * ((channels_1 == 1u) ? vec3(_e117) : _e115));
}

float vol_in_first_node(float shift, int block) {
    float moved = floor((float(block) * (0.5 + shift)));
    float middle = ((0.5 + shift) - (float((block - 1)) - moved));
    return (VOL_IN_CORRECTED ? ((shift > 0.0) ? (shift - 1.0) : shift) : middle);
}

uint vol_in_medium_word(uint medium) {
    return (VOL_IN_AT_MEDIA + (VOL_IN_MEDIUM_WORDS * medium));
}

int vol_in_spacing_of(inout Vol_in_Comb comb, uint medium_1) {
    bool local_4 = false;
    if (VOL_IN_SPACED) {
        int _e6 = comb.block;
        local_4 = (_e6 > 1);
    } else {
        local_4 = false;
    }
    bool _e10 = local_4;
    if (_e10) {
        uint _e11 = vol_in_medium_word(medium_1);
        float _e14 = vol_frame_word((_e11 + 8u));
        return int(_e14);
    }
    return 1;
}

ivec2 vol_in_node_range(Vol_in_Ray ray_17, vec3 lo_3, vec3 hi_3, int spacing, inout Vol_in_Comb comb_1) {
    float step_size_2 = comb_1.step_;
    vec3 reach_2 = vec3(((1.01 * float(spacing)) * step_size_2));
    Vol_in_Span _e14 = vol_in_slab(ray_17, (lo_3 - reach_2), (hi_3 + reach_2));
    float _e17 = comb_1.end;
    float leave_1 = min(_e14.leave, _e17);
    float _e22 = comb_1.offset;
    float first_4 = min(max(floor(((_e14.entry / step_size_2) - _e22)), 0.0), VOL_IN_LAST_NODE);
    float _e33 = comb_1.offset;
    float last_7 = min(floor(((max(leave_1, 0.0) / step_size_2) - _e33)), VOL_IN_LAST_NODE);
    return ((_e14.entry > leave_1) ? ivec2(0, -1) : ivec2(int(first_4), int(last_7)));
}

Vol_in_Runs vol_in_add_run(Vol_in_Runs before_3, ivec2 nodes) {
    vec2 range = vec2(nodes);
    bvec4 continued = bvec4(lessThanEqual(before_3.first, vec4((range.y + 2.0))).x && greaterThanEqual(before_3.last, vec4((range.x - 2.0))).x, lessThanEqual(before_3.first, vec4((range.y + 2.0))).y && greaterThanEqual(before_3.last, vec4((range.x - 2.0))).y, lessThanEqual(before_3.first, vec4((range.y + 2.0))).z && greaterThanEqual(before_3.last, vec4((range.x - 2.0))).z, lessThanEqual(before_3.first, vec4((range.y + 2.0))).w && greaterThanEqual(before_3.last, vec4((range.x - 2.0))).w);
    vec4 own_first = mix(vec4(8388608.0), before_3.first, continued);
    vec4 own_last = mix(vec4(-1.0), before_3.last, continued);
    float first_5 = min(range.x, min(min(own_first.x, own_first.y), min(own_first.z, own_first.w)));
    float last_8 = max(range.y, max(max(own_last.x, own_last.y), max(own_last.z, own_last.w)));
    vec4 kept_first = mix(before_3.first, vec4(8388608.0), continued);
    vec4 kept_last = mix(before_3.last, vec4(-1.0), continued);
    bvec4 free_2 = equal(kept_first, vec4(8388608.0));
    bvec4 place_10 = bvec4(free_2.x, (free_2.y && !(free_2.x)), (free_2.z && !((free_2.x || free_2.y))), !(((free_2.x || free_2.y) || free_2.z)));
    return Vol_in_Runs(mix(kept_first, min(kept_first, vec4(first_5)), place_10), mix(kept_last, max(kept_last, vec4(last_8)), place_10));
}

Vol_in_Runs vol_in_find_runs(Vol_in_Ray ray_18, uint medium_2, inout Vol_in_Comb comb_2) {
    Vol_in_Runs runs = Vol_in_Runs(vec4(8388608.0), vec4(-1.0));
    uint cell = 0u;
    uint index_17 = 0u;
    uint _e3 = vol_in_medium_word(medium_2);
    int _e4 = vol_in_spacing_of(comb_2, medium_2);
    vec3 _e13 = vol_in_word3_((_e3 + 1u));
    vec3 _e16 = vol_in_word3_((_e3 + 4u));
    ivec2 _e17 = vol_in_node_range(ray_18, _e13, _e16, _e4, comb_2);
    float _e21 = vol_frame_word(_e3);
    if (((_e17.x > _e17.y) || (_e21 == 0.0))) {
        Vol_in_Runs _e25 = runs;
        return _e25;
    }
    float _e28 = vol_frame_word((_e3 + 7u));
    uint count_5 = uint(_e28);
    if ((count_5 == 0u)) {
        Vol_in_Runs _e32 = runs;
        Vol_in_Runs _e33 = vol_in_add_run(_e32, _e17);
        return _e33;
    }
    cell = (VOL_IN_AT_CELLS + (VOL_IN_CELLS_WORDS * medium_2));
    bool loop_init_24 = true;
    while(true) {
        if (!loop_init_24) {
            uint _e59 = index_17;
            index_17 = (_e59 + 1u);
        }
        loop_init_24 = false;
        uint _e41 = index_17;
        if ((_e41 < count_5)) {
        } else {
            break;
        }
        {
            uint _e43 = cell;
            vec3 _e44 = vol_in_word3_(_e43);
            uint _e45 = cell;
            vec3 _e48 = vol_in_word3_((_e45 + 3u));
            ivec2 _e49 = vol_in_node_range(ray_18, _e44, _e48, _e4, comb_2);
            if ((_e49.x <= _e49.y)) {
                Vol_in_Runs _e53 = runs;
                Vol_in_Runs _e54 = vol_in_add_run(_e53, _e49);
                runs = _e54;
            }
            uint _e55 = cell;
            cell = (_e55 + VOL_IN_CELL_WORDS);
        }
    }
    Vol_in_Runs _e61 = runs;
    return _e61;
}

ivec2 vol_in_run_from(Vol_in_Runs runs_1, int node) {
    float earliest_1 = float(node);
    vec4 first_6 = mix(vec4(8388608.0), max(runs_1.first, vec4(earliest_1)), greaterThanEqual(runs_1.last, vec4(earliest_1)));
    float least_4 = min(min(first_6.x, first_6.y), min(first_6.z, first_6.w));
    vec4 last_9 = mix(vec4(earliest_1), runs_1.last, equal(first_6, vec4(least_4)));
    int end_14 = int(max(max(last_9.x, last_9.y), max(last_9.z, last_9.w)));
    return ivec2(int(least_4), ((least_4 == VOL_IN_NO_RUN) ? VOL_IN_NO_NODE : end_14));
}

Vol_in_Comb vol_in_new_comb(Vol_in_Ray ray_19, float end_4, float step_size, int block_1) {
    Vol_in_Comb comb_3 = Vol_in_Comb(0.0, 0.0, 0, 0.0, 0, 0, Vol_in_Runs[1](Vol_in_Runs(vec4(0.0), vec4(0.0))), ivec2[1](ivec2(0)), float[1](0.0), 0, float[1](0.0));
    comb_3.step_ = step_size;
    comb_3.block = block_1;
    float _e9 = vol_in_first_node(ray_19.shift, block_1);
    comb_3.offset = _e9;
    comb_3.end = end_4;
    comb_3.first = VOL_IN_NO_NODE;
    comb_3.last = -1;
    {
        Vol_in_Runs _e16 = vol_in_find_runs(ray_19, 0u, comb_3);
        comb_3.all_[0u] = _e16;
        ivec2 _e22 = vol_in_run_from(_e16, 0);
        comb_3.runs[0u] = _e22;
        int _e25 = comb_3.first;
        int _e29 = comb_3.runs[0u].x;
        comb_3.first = min(_e25, _e29);
        int _e33 = comb_3.last;
        comb_3.last = max(_e33, int(max(max(_e16.last.x, _e16.last.y), max(_e16.last.z, _e16.last.w))));
        comb_3.before[0u] = VOL_IN_FAR;
        comb_3.own[0u] = VOL_IN_FAR;
    }
    int _e55 = comb_3.last;
    int _e57 = comb_3.first;
    comb_3.last = min(_e55, (_e57 + 16383));
    Vol_in_Comb _e61 = comb_3;
    return _e61;
}

int vol_in_spacing_at(inout Vol_in_Comb comb_4, int step_3) {
    int spacing_1 = 0;
    int _e3 = comb_4.block;
    spacing_1 = _e3;
    if (VOL_IN_SPACED) {
        int _e8 = spacing_1;
        int first_7 = (max(step_3, 0) & -(_e8));
        int _e11 = spacing_1;
        float last_10 = float((first_7 + (_e11 - 1)));
        {
            Vol_in_Runs runs_2 = comb_4.all_[0u];
            bool there_2 = any(bvec4(lessThanEqual(runs_2.first, vec4(last_10)).x && greaterThanEqual(runs_2.last, vec4(float(first_7))).x, lessThanEqual(runs_2.first, vec4(last_10)).y && greaterThanEqual(runs_2.last, vec4(float(first_7))).y, lessThanEqual(runs_2.first, vec4(last_10)).z && greaterThanEqual(runs_2.last, vec4(float(first_7))).z, lessThanEqual(runs_2.first, vec4(last_10)).w && greaterThanEqual(runs_2.last, vec4(float(first_7))).w));
            int _e29 = spacing_1;
            int _e30 = spacing_1;
            int _e31 = vol_in_spacing_of(comb_4, 0u);
            spacing_1 = (there_2 ? min(_e30, _e31) : _e29);
        }
    }
    int _e34 = spacing_1;
    return _e34;
}

bool vol_in_is_block_begun(inout Vol_in_Comb comb_5, int step_4) {
    int _e3 = comb_5.block;
    return ((step_4 & (_e3 - 1)) == 0);
}

Vol_in_Node vol_in_node_before(inout Vol_in_Comb comb_6, Vol_in_Node node_1) {
    int steps = 0;
    bool local_5 = false;
    steps = node_1.steps;
    if (VOL_IN_SPACED) {
        bool _e8 = vol_in_is_block_begun(comb_6, node_1.first);
        local_5 = _e8;
    } else {
        local_5 = false;
    }
    bool _e10 = local_5;
    if (_e10) {
        int _e14 = vol_in_spacing_at(comb_6, (node_1.first - 1));
        steps = _e14;
    }
    int _e16 = steps;
    int _e18 = steps;
    return Vol_in_Node((node_1.first - _e16), _e18, (node_1.number - 1));
}

Vol_in_Node vol_in_node_at(inout Vol_in_Comb comb_7, Vol_in_Node known, int step_5) {
    if (true) {
        return Vol_in_Node(step_5, 1, step_5);
    }
    int block_2 = comb_7.block;
    int own_end = ((known.first | (block_2 - 1)) + 1);
    if ((step_5 < own_end)) {
        int more_2 = ((step_5 - known.first) / known.steps);
        return Vol_in_Node((known.first + (more_2 * known.steps)), known.steps, (known.number + more_2));
    }
    int begin_1 = (step_5 & -(block_2));
    int _e29 = vol_in_spacing_at(comb_7, step_5);
    int whole_2 = (((own_end - known.first) / known.steps) + ((begin_1 - own_end) / block_2));
    int more_3 = ((step_5 - begin_1) / _e29);
    return Vol_in_Node((begin_1 + (more_3 * _e29)), _e29, (known.number + (whole_2 + more_3)));
}

Vol_in_Node vol_in_node_ahead(inout Vol_in_Comb comb_8, Vol_in_Node earliest, int step_6, int lead) {
    Vol_in_Node node_2 = Vol_in_Node(0, 0, 0);
    int back = 0;
    if (true) {
        int first_8 = max(earliest.first, (step_6 - lead));
        return Vol_in_Node(first_8, 1, first_8);
    }
    node_2 = earliest;
    if ((step_6 > earliest.first)) {
        Vol_in_Node _e13 = vol_in_node_at(comb_8, earliest, step_6);
        node_2 = _e13;
        bool loop_init_25 = true;
        while(true) {
            if (!loop_init_25) {
                int _e25 = back;
                back = (_e25 + 1);
            }
            loop_init_25 = false;
            int _e16 = back;
            if ((_e16 < lead)) {
            } else {
                break;
            }
            {
                int _e19 = node_2.number;
                if ((_e19 > earliest.number)) {
                    Vol_in_Node _e22 = node_2;
                    Vol_in_Node _e23 = vol_in_node_before(comb_8, _e22);
                    node_2 = _e23;
                }
            }
        }
    }
    Vol_in_Node _e27 = node_2;
    return _e27;
}

Vol_in_Node vol_in_start_node(inout Vol_in_Comb comb_9, int lead_1) {
    Vol_in_Node before_4 = Vol_in_Node(0, 0, 0);
    int back_1 = 0;
    int _e3 = vol_in_spacing_at(comb_9, 0);
    Vol_in_Node origin_2 = Vol_in_Node(0, _e3, 0);
    before_4 = origin_2;
    bool loop_init_26 = true;
    while(true) {
        if (!loop_init_26) {
            int _e15 = back_1;
            back_1 = (_e15 + 1);
        }
        loop_init_26 = false;
        int _e10 = back_1;
        if ((_e10 < lead_1)) {
        } else {
            break;
        }
        {
            Vol_in_Node _e12 = before_4;
            Vol_in_Node _e13 = vol_in_node_before(comb_9, _e12);
            before_4 = _e13;
        }
    }
    Vol_in_Node _e17 = before_4;
    int _e19 = comb_9.first;
    Vol_in_Node _e20 = vol_in_node_ahead(comb_9, _e17, _e19, lead_1);
    return _e20;
}

Vol_in_Node vol_in_next_node(inout Vol_in_Comb comb_10, Vol_in_Node node_3, Vol_in_Node after, int lead_2) {
    int first_1 = VOL_IN_NO_NODE;
    {
        int _e10 = comb_10.runs[0u].y;
        if ((_e10 < after.first)) {
            Vol_in_Runs _e17 = comb_10.all_[0u];
            ivec2 _e19 = vol_in_run_from(_e17, after.first);
            comb_10.runs[0u] = _e19;
        }
        int _e20 = first_1;
        int _e24 = comb_10.runs[0u].x;
        first_1 = min(_e20, _e24);
    }
    int _e26 = first_1;
    Vol_in_Node _e27 = vol_in_node_ahead(comb_10, after, _e26, lead_2);
    bool is_farther = (_e27.first > after.first);
    comb_10.steps_before = node_3.steps;
    {
        float _e38 = comb_10.before[0u];
        comb_10.before[0u] = (is_farther ? VOL_IN_FAR : _e38);
        float _e45 = comb_10.own[0u];
        comb_10.own[0u] = (is_farther ? VOL_IN_FAR : _e45);
    }
    return _e27;
}

Vol_in_Node vol_in_node_after(inout Vol_in_Comb comb_11, Vol_in_Node node_4) {
    Vol_in_Node after_1 = Vol_in_Node(0, 0, 0);
    bool local_6 = false;
    after_1 = Vol_in_Node((node_4.first + node_4.steps), node_4.steps, (node_4.number + 1));
    if (VOL_IN_SPACED) {
        int _e15 = after_1.first;
        bool _e16 = vol_in_is_block_begun(comb_11, _e15);
        local_6 = _e16;
    } else {
        local_6 = false;
    }
    bool _e18 = local_6;
    if (_e18) {
        int _e21 = after_1.first;
        int _e22 = vol_in_spacing_at(comb_11, _e21);
        after_1.steps = _e22;
    }
    Vol_in_Node _e23 = after_1;
    return _e23;
}

float vol_in_wall(Vol_in_Ray ray_20, uint medium_3, ivec2 run, float t_28, Vol_in_Node node_5, int steps_before, float end_5) {
    float region = VOL_IN_FAR;
    if ((((node_5.first + (2 * node_5.steps)) > run.x) && (node_5.first <= (run.y + max(node_5.steps, steps_before))))) {
        vec3 _e23 = vol_in_ray_at(ray_20, t_28);
        float _e24 = vol_in_medium_region(medium_3, _e23);
        region = _e24;
    }
    float _e25 = region;
    return max(_e25, max((t_28 - end_5), -(t_28)));
}

float vol_in_node_distance(int node_6, float step_size_1, float offset) {
    return ((float(node_6) + offset) * step_size_1);
}

float vol_in_middle_of(inout Vol_in_Comb comb_12, Vol_in_Node node_7) {
    float _e4 = comb_12.step_;
    float _e6 = comb_12.offset;
    float _e14 = vol_in_node_distance(node_7.first, _e4, (_e6 + (0.5 * float((node_7.steps - 1)))));
    return _e14;
}

float vol_in_share(vec2 own, vec2 other) {
    float divisor_4 = ((own.x < other.x) ? (own.x - other.x) : -1.0);
    float part_5 = ((own.y + other.y) * (own.x / divisor_4));
    return ((other.x < 0.0) ? own.y : part_5);
}

float vol_in_weigh(Vol_in_Ray ray_21, uint medium_4, inout Vol_in_Comb comb_13, Vol_in_Node node_8, Vol_in_Node next) {
    int _e6 = comb_13.steps_before;
    float _e12 = comb_13.step_;
    vec3 halves = (0.5 * (vec3(ivec3(_e6, node_8.steps, next.steps)) * _e12));
    float before_9 = comb_13.before[medium_4];
    float own_1 = comb_13.own[medium_4];
    ivec2 _e24 = comb_13.runs[medium_4];
    float _e25 = vol_in_middle_of(comb_13, next);
    float _e28 = comb_13.end;
    float _e29 = vol_in_wall(ray_21, medium_4, _e24, _e25, next, node_8.steps, _e28);
    vec2 here_1 = vec2(own_1, halves.y);
    float _e34 = vol_in_share(here_1, vec2(before_9, halves.x));
    float _e37 = vol_in_share(here_1, vec2(_e29, halves.z));
    float weight = (_e34 + _e37);
    comb_13.before[medium_4] = own_1;
    comb_13.own[medium_4] = _e29;
    int _e47 = comb_13.first;
    return (((own_1 < 0.0) && (next.first > _e47)) ? weight : 0.0);
}

vec3 vol_in_optical_depth(Vol_in_Ray ray_22, float end_6) {
    Vol_in_Comb comb_14 = Vol_in_Comb(0.0, 0.0, 0, 0.0, 0, 0, Vol_in_Runs[1](Vol_in_Runs(vec4(0.0), vec4(0.0))), ivec2[1](ivec2(0)), float[1](0.0), 0, float[1](0.0));
    vec4 ahead_2[1] = vec4[1](vec4(0.0));
    vec3 depth_1 = vec3(0.0);
    Vol_in_Node next_1 = Vol_in_Node(0, 0, 0);
    Vol_in_Node node_9 = Vol_in_Node(0, 0, 0);
    vec3 node_depth = vec3(0.0);
    float _e3 = vol_frame_word(VOL_IN_AT_SHADOW_STEP);
    Vol_in_Comb _e5 = vol_in_new_comb(ray_22, end_6, _e3, 1);
    comb_14 = _e5;
    Vol_in_Node _e13 = vol_in_start_node(comb_14, 2);
    node_9 = _e13;
    bool loop_init_27 = true;
    while(true) {
        if (!loop_init_27) {
            Vol_in_Node _e56 = node_9;
            Vol_in_Node _e57 = next_1;
            Vol_in_Node _e59 = vol_in_next_node(comb_14, _e56, _e57, 2);
            node_9 = _e59;
        }
        loop_init_27 = false;
        int _e16 = node_9.first;
        int _e18 = comb_14.last;
        if ((_e16 <= _e18)) {
        } else {
            break;
        }
        {
            Vol_in_Node _e20 = node_9;
            Vol_in_Node _e21 = vol_in_node_after(comb_14, _e20);
            next_1 = _e21;
            node_depth = vec3(0.0);
            {
                Vol_in_Node _e26 = node_9;
                Vol_in_Node _e27 = next_1;
                float _e28 = vol_in_weigh(ray_22, 0u, comb_14, _e26, _e27);
                vec4 matter = ahead_2[0u];
                float _e33 = comb_14.own[0u];
                if ((_e33 < 0.0)) {
                    Vol_in_Node _e37 = next_1;
                    float _e38 = vol_in_middle_of(comb_14, _e37);
                    vec3 _e39 = vol_in_ray_at(ray_22, _e38);
                    vec4 _e40 = vol_in_medium_extinction(0u, _e39);
                    ahead_2[0u] = _e40;
                }
                vec3 _e41 = node_depth;
                node_depth = (_e41 + (matter.yzw * (max(matter.x, 0.0) * _e28)));
            }
            vec3 _e49 = depth_1;
            vec3 _e50 = node_depth;
            depth_1 = (_e49 + _e50);
            vec3 _e52 = depth_1;
            float _e53 = vol_in_smallest(_e52);
            if ((_e53 > VOL_IN_OPAQUE)) {
                break;
            }
        }
    }
    vec3 _e60 = depth_1;
    return _e60;
}

vec3 vol_in_depth_towards(Vol_in_Ray ray_23, float distance_6, uint grid_1) {
    if (VOL_IN_LIGHT_GRIDS) {
        if ((grid_1 != 0u)) {
            vec3 _e7 = vol_in_grid_depth(grid_1, ray_23.origin);
            return _e7;
        }
    }
    vec3 _e8 = vol_in_optical_depth(ray_23, distance_6);
    return _e8;
}

vec3 vol_in_through_media(Vol_in_Ray ray_24, float distance_7, float part, uint grid_2) {
    if ((part <= 0.0)) {
        return vec3(0.0);
    }
    vec3 _e8 = vol_in_depth_towards(ray_24, distance_7, grid_2);
    vec3 _e9 = vol_in_decay3_(_e8);
    float _e13 = vol_in_smallest(_e8);
    return ((_e13 > VOL_IN_OPAQUE) ? vec3(0.0) : (_e9 * part));
}

vec3 vol_in_soft_visibility(Vol_in_Ray ray_25, float distance_8, float bias_1, float slope_6, uint grid_3) {
    float part_1 = 0.0;
    bool local_7 = false;
    if (VOL_IN_SOFT_LIGHTS) {
        local_7 = (slope_6 > 0.0);
    } else {
        local_7 = false;
    }
    bool _e13 = local_7;
    if (_e13) {
        float _e16 = vol_in_lit_part_of(ray_25, distance_8, (0.25 * bias_1), slope_6);
        part_1 = _e16;
    } else {
        float _e17 = vol_in_unblocked(ray_25, distance_8, bias_1);
        part_1 = _e17;
    }
    float _e18 = part_1;
    vec3 _e19 = vol_in_through_media(ray_25, distance_8, _e18, grid_3);
    return _e19;
}

vec3 vol_in_surface_visibility(Vol_in_Arriving lamp, Vol_in_Contact contact) {
    if (!(lamp.shadows)) {
        return vec3(1.0);
    }
    float _e7 = vol_in_shadow_bias(contact.t);
    float offset_1 = max(_e7, (2.0 * contact.residual));
    vec3 origin_3 = (contact.position + (contact.normal * offset_1));
    Vol_in_Ray _e17 = vol_in_new_ray(origin_3, lamp.direction);
    vec3 _e21 = vol_in_soft_visibility(_e17, lamp.distance_, _e7, lamp.slope, lamp.grid);
    return _e21;
}

float vol_in_distance_above(Vol_in_Contact contact_1, float height, inout float sides_6[1]) {
    float distance_9 = 0.0;
    float others_1 = 0.0;
    float farthest_1 = -4000000.0;
    uint solid_14 = 0u;
    vec3 point_6 = (contact_1.position + (contact_1.normal * height));
    distance_9 = height;
    others_1 = height;
    bool loop_init_28 = true;
    while(true) {
        if (!loop_init_28) {
            uint _e56 = solid_14;
            solid_14 = (_e56 + 1u);
        }
        loop_init_28 = false;
        uint _e13 = solid_14;
        if ((_e13 < VOL_IN_OBJECT_COUNT)) {
        } else {
            break;
        }
        {
            uint _e16 = solid_14;
            bool _e17 = vol_in_joins_the_one_before(_e16);
            uint _e18 = solid_14;
            float _e20 = sides_6[_e18];
            if (!((_e17 && (_e20 < 0.0)))) {
                float _e25 = distance_9;
                others_1 = _e25;
                farthest_1 = -4000000.0;
            }
            uint _e27 = solid_14;
            uint _e28 = vol_in_object_word(_e27);
            vec3 _e31 = vol_in_word3_((_e28 + 1u));
            vec3 lo_4 = (_e31 - vec3(height));
            vec3 _e36 = vol_in_word3_((_e28 + 4u));
            vec3 hi_4 = (_e36 + vec3(height));
            bool _e39 = vol_in_contains(lo_4, hi_4, point_6);
            float _e40 = vol_frame_word(_e28);
            if ((_e39 && (_e40 != 0.0))) {
                float _e44 = farthest_1;
                uint _e45 = solid_14;
                float _e47 = sides_6[_e45];
                uint _e48 = solid_14;
                float _e49 = vol_in_object_distance(_e48, point_6);
                farthest_1 = max(_e44, (_e47 * _e49));
                float _e52 = others_1;
                float _e53 = farthest_1;
                distance_9 = min(_e52, _e53);
            }
        }
    }
    float _e58 = distance_9;
    return _e58;
}

float vol_in_openness(Vol_in_Contact contact_2, float reach) {
    float weights[5] = VOL_IN_WEIGHTS;
    float sides_7[1] = float[1](0.0);
    float hidden = 0.0;
    uint index_18 = 0u;
    vol_in_find_sides(sides_7);
    bool loop_init_29 = true;
    while(true) {
        if (!loop_init_29) {
            uint _e35 = index_18;
            index_18 = (_e35 + 1u);
        }
        loop_init_29 = false;
        uint _e9 = index_18;
        if ((_e9 < VOL_IN_WEIGHT_COUNT)) {
        } else {
            break;
        }
        {
            uint _e12 = index_18;
            float share = (float((_e12 + 1u)) / 5.0);
            float height_1 = (share * reach);
            float _e19 = vol_in_distance_above(contact_2, height_1, sides_7);
            float lack = max(((height_1 - _e19) / height_1), 0.0);
            float _e24 = hidden;
            uint _e25 = index_18;
            float _e27 = weights[_e25];
            hidden = (_e24 + (_e27 * min((0.5 * lack), 1.0)));
        }
    }
    float _e37 = hidden;
    return (1.0 - min((_e37 / VOL_IN_WEIGHT_SUM), 1.0));
}

vec3 vol_in_answer(Vol_in_Response response, Vol_in_Contact contact_3, Vol_in_Arriving lamp_1, float cosine, vec3 direction_1) {
    vec3 mirrored = ((contact_3.normal * (2.0 * cosine)) - lamp_1.direction);
    float _e12 = vol_in_dot3_(mirrored, -(direction_1));
    float _e14 = vol_in_power(_e12, response.shininess);
    return ((response.diffuse * cosine) + (response.specular * _e14));
}

vec3 vol_in_shade(Vol_in_Ray ray_26, Vol_in_Contact contact_4) {
    vec3 color = vec3(0.0);
    uint light_1 = 0u;
    vec3 seen = vec3(0.0);
    uint _e3 = vol_in_object_word(contact_4.solid);
    float _e4 = vol_frame_word(_e3);
    if ((_e4 == VOL_IN_SHOWS_NORMALS)) {
        return ((contact_4.normal + vec3(1.0)) * 0.5);
    }
    Vol_in_Response _e15 = vol_in_object_surface(contact_4.solid, contact_4.position);
    bool answers = (any(notEqual(_e15.diffuse, vec3(0.0))) || any(notEqual(_e15.specular, vec3(0.0))));
    color = _e15.emitted;
    uint _e30 = vol_in_light_count();
    uint count_6 = (answers ? _e30 : 0u);
    bool loop_init_30 = true;
    while(true) {
        if (!loop_init_30) {
            uint _e69 = light_1;
            light_1 = (_e69 + 1u);
        }
        loop_init_30 = false;
        uint _e34 = light_1;
        if ((_e34 < count_6)) {
        } else {
            break;
        }
        {
            uint _e36 = light_1;
            Vol_in_Arriving _e38 = vol_in_arriving(_e36, contact_4.position);
            float _e41 = vol_in_dot3_(contact_4.normal, _e38.direction);
            if ((_e41 > 0.0)) {
                vec3 _e44 = vol_in_surface_visibility(_e38, contact_4);
                seen = _e44;
                if (VOL_IN_OCCLUDING_LIGHTS) {
                    uint _e49 = light_1;
                    float _e54 = vol_frame_word(((VOL_IN_AT_LIGHTS + (VOL_IN_LIGHT_WORDS * _e49)) + 9u));
                    if ((_e54 > 0.0)) {
                        vec3 _e57 = seen;
                        float _e58 = vol_in_openness(contact_4, _e54);
                        seen = (_e57 * _e58);
                    }
                }
                vec3 _e60 = color;
                vec3 _e62 = seen;
                vec3 _e65 = vol_in_answer(_e15, contact_4, _e38, _e41, ray_26.direction);
                color = (_e60 + ((_e38.irradiance * _e62) * _e65));
            }
        }
    }
    vec3 _e71 = color;
    return _e71;
}

Vol_in_Glow vol_in_clear_glow() {
    return Vol_in_Glow(vec3(0.0), vec3(1.0), vec3(0.0), vec3(1.0));
}

Vol_in_StyledRays vol_in_style_rays(Vol_in_Ray ray_27, float end_7) {
    return Vol_in_StyledRays(0.0);
}

int vol_in_widest_spacing() {
    int widest_1 = 1;
    if (VOL_IN_SPACED) {
        {
            int _e4 = widest_1;
            uint _e5 = vol_in_medium_word(0u);
            float _e8 = vol_frame_word((_e5 + 8u));
            widest_1 = max(_e4, int(_e8));
        }
    }
    int _e11 = widest_1;
    return _e11;
}

Vol_in_Glow vol_in_gather(Vol_in_Glow before_5, int node_10, Vol_in_Chunk chunk) {
    Vol_in_Glow glow = Vol_in_Glow(vec3(0.0), vec3(0.0), vec3(0.0), vec3(0.0));
    glow = before_5;
    vec3 _e5 = vol_in_decay3_(chunk.depth);
    vec3 _e7 = glow.light;
    vec3 _e9 = glow.transmittance;
    glow.light = (_e7 + (_e9 * chunk.sent));
    vec3 _e15 = glow.transmittance;
    glow.transmittance = (_e15 * _e5);
    if (((node_10 % 2) == 0)) {
        vec3 twice = (chunk.sent * (vec3(1.0) + _e5));
        vec3 _e27 = glow.coarse_light;
        vec3 _e29 = glow.coarse_transmittance;
        glow.coarse_light = (_e27 + (_e29 * twice));
        vec3 _e34 = glow.coarse_transmittance;
        glow.coarse_transmittance = (_e34 * (_e5 * _e5));
    }
    Vol_in_Glow _e37 = glow;
    return _e37;
}

float vol_in_styled_share(Vol_in_Arriving lamp_2, uint light_2, inout Vol_in_StyledRays rays, Vol_in_Ray ray_28, float t_29) {
    return 1.0;
}

vec3 vol_in_place_visibility(Vol_in_Arriving lamp_3, uint light_3, inout Vol_in_StyledRays styled, Vol_in_Ray ray_29, float t_30, inout vec3 scatter[1]) {
    bool asked = false;
    float part_2 = 1.0;
    bool local_8 = false;
    {
        vec3 _e10 = scatter[0u];
        bool scatters = any(greaterThan(_e10, vec3(0.0)));
        bool _e15 = asked;
        uint _e16 = vol_in_medium_word(0u);
        float _e17 = vol_frame_word(_e16);
        asked = (_e15 || (scatters && (_e17 == VOL_IN_SHADOWED)));
    }
    bool _e22 = asked;
    if ((_e22 && lamp_3.shadows)) {
        vec3 _e25 = vol_in_ray_at(ray_29, t_30);
        Vol_in_Ray _e27 = vol_in_new_ray(_e25, lamp_3.direction);
        if (VOL_IN_STYLES) {
            local_8 = (lamp_3.style != 0u);
        } else {
            local_8 = false;
        }
        bool _e37 = local_8;
        if (_e37) {
            float _e38 = vol_in_styled_share(lamp_3, light_3, styled, ray_29, t_30);
            part_2 = _e38;
        } else {
            float _e40 = vol_in_shadow_bias(t_30);
            float _e41 = vol_in_unblocked(_e27, lamp_3.distance_, _e40);
            part_2 = _e41;
        }
        float _e43 = part_2;
        vec3 _e45 = vol_in_through_media(_e27, lamp_3.distance_, _e43, lamp_3.grid);
        return _e45;
    }
    return vec3(1.0);
}

vec3 vol_in_styled_tint(Vol_in_Arriving lamp_4, uint light_4, inout Vol_in_StyledRays rays_1, vec3 point_5) {
    return vec3(1.0);
}

vec2 vol_in_turn(vec3 toward_1, vec3 direction_2) {
    vec3 apart = (toward_1 - direction_2);
    vec3 together = (toward_1 + direction_2);
    float _e4 = vol_in_dot3_(apart, apart);
    float _e7 = vol_in_dot3_(together, together);
    return vec2((0.5 * _e4), (0.5 * _e7));
}

void vol_in_scatter_light(Vol_in_Arriving lamp_5, vec3 seen_1, vec3 direction_3, inout vec3 scatter_1[1], inout vec3 source[1]) {
    vec2 _e6 = vol_in_turn(lamp_5.direction, direction_3);
    {
        uint _e8 = vol_in_medium_word(0u);
        float _e9 = vol_frame_word(_e8);
        vec3 part_6 = scatter_1[0u];
        if ((any(greaterThan(part_6, vec3(0.0))) && (_e9 > VOL_IN_UNLIT))) {
            float _e21 = vol_in_medium_phase(0u, _e6.x, _e6.y);
            vec3 arrives = ((_e9 == VOL_IN_UNSHADOWED) ? vec3(1.0) : seen_1);
            vec3 _e28 = source[0u];
            source[0u] = (_e28 + ((part_6 * _e21) * (lamp_5.irradiance * arrives)));
            return;
        } else {
            return;
        }
    }
}

void vol_in_light_place(Vol_in_Ray ray_30, float t_31, inout Vol_in_StyledRays styled_1, inout vec3 scatter_2[1], inout vec3 source_1[1]) {
    uint light_5 = 0u;
    vec3 seen_2 = vec3(0.0);
    bool local_9 = false;
    vec3 _e5 = vol_in_ray_at(ray_30, t_31);
    uint _e6 = vol_in_light_count();
    bool loop_init_31 = true;
    while(true) {
        if (!loop_init_31) {
            uint _e31 = light_5;
            light_5 = (_e31 + 1u);
        }
        loop_init_31 = false;
        uint _e9 = light_5;
        if ((_e9 < _e6)) {
        } else {
            break;
        }
        {
            uint _e11 = light_5;
            Vol_in_Arriving _e12 = vol_in_arriving(_e11, _e5);
            uint _e13 = light_5;
            vec3 _e14 = vol_in_place_visibility(_e12, _e13, styled_1, ray_30, t_31, scatter_2);
            seen_2 = _e14;
            if (VOL_IN_STYLES) {
                local_9 = (_e12.style != 0u);
            } else {
                local_9 = false;
            }
            bool _e23 = local_9;
            if (_e23) {
                vec3 _e24 = seen_2;
                uint _e25 = light_5;
                vec3 _e26 = vol_in_styled_tint(_e12, _e25, styled_1, _e5);
                seen_2 = (_e24 * _e26);
            }
            vec3 _e28 = seen_2;
            vol_in_scatter_light(_e12, _e28, ray_30.direction, scatter_2, source_1);
        }
    }
    return;
}

Vol_in_Chunk vol_in_node_chunk(Vol_in_Ray ray_31, float t_32, inout Vol_in_StyledRays styled_2, inout float weights_1[1], inout Vol_in_Interior interiors[1]) {
    vec3 depth_2 = vec3(0.0);
    vec3 scatter_3[1] = vec3[1](vec3(0.0));
    vec3 source_2[1] = vec3[1](vec3(0.0));
    vec3 sent = vec3(0.0);
    {
        float weight_1 = weights_1[0u];
        scatter_3[0u] = vec3(0.0);
        source_2[0u] = vec3(0.0);
        if ((weight_1 > 0.0)) {
            Vol_in_Interior interior = interiors[0u];
            float mass = (max(interior.density, 0.0) * weight_1);
            vec3 _e27 = depth_2;
            depth_2 = (_e27 + (interior.extinction * mass));
            scatter_3[0u] = (interior.scattering * mass);
            source_2[0u] = (interior.emission * mass);
        }
    }
    if (VOL_IN_LIT_MEDIA) {
        vol_in_light_place(ray_31, t_32, styled_2, scatter_3, source_2);
    }
    {
        vec3 _e42 = sent;
        vec3 _e44 = source_2[0u];
        vec3 _e45 = depth_2;
        vec3 _e46 = vol_in_mean_decay3_(_e45);
        sent = (_e42 + (_e44 * _e46));
    }
    vec3 _e49 = sent;
    vec3 _e50 = depth_2;
    return Vol_in_Chunk(_e49, _e50);
}

Vol_in_Glow vol_in_march(Vol_in_Ray ray_32, float end_8) {
    Vol_in_Glow glow_1 = Vol_in_Glow(vec3(0.0), vec3(0.0), vec3(0.0), vec3(0.0));
    Vol_in_StyledRays styled_3 = Vol_in_StyledRays(0.0);
    Vol_in_Comb comb_15 = Vol_in_Comb(0.0, 0.0, 0, 0.0, 0, 0, Vol_in_Runs[1](Vol_in_Runs(vec4(0.0), vec4(0.0))), ivec2[1](ivec2(0)), float[1](0.0), 0, float[1](0.0));
    float weights_2[1] = float[1](0.0);
    Vol_in_Interior here[1] = Vol_in_Interior[1](Vol_in_Interior(0.0, vec3(0.0), vec3(0.0), vec3(0.0)));
    Vol_in_Interior ahead_3[1] = Vol_in_Interior[1](Vol_in_Interior(0.0, vec3(0.0), vec3(0.0), vec3(0.0)));
    Vol_in_Node next_2 = Vol_in_Node(0, 0, 0);
    Vol_in_Node node_11 = Vol_in_Node(0, 0, 0);
    bool some = false;
    Vol_in_Glow _e2 = vol_in_clear_glow();
    glow_1 = _e2;
    Vol_in_StyledRays _e4 = vol_in_style_rays(ray_32, end_8);
    styled_3 = _e4;
    float _e7 = vol_frame_word(VOL_IN_AT_STEP);
    int _e8 = vol_in_widest_spacing();
    Vol_in_Comb _e9 = vol_in_new_comb(ray_32, end_8, _e7, _e8);
    comb_15 = _e9;
    Vol_in_Node _e16 = vol_in_start_node(comb_15, 2);
    node_11 = _e16;
    bool loop_init_32 = true;
    while(true) {
        if (!loop_init_32) {
            Vol_in_Node _e64 = node_11;
            Vol_in_Node _e65 = next_2;
            Vol_in_Node _e67 = vol_in_next_node(comb_15, _e64, _e65, 2);
            node_11 = _e67;
        }
        loop_init_32 = false;
        int _e19 = node_11.first;
        int _e21 = comb_15.last;
        if ((_e19 <= _e21)) {
        } else {
            break;
        }
        {
            Vol_in_Node _e23 = node_11;
            Vol_in_Node _e24 = vol_in_node_after(comb_15, _e23);
            next_2 = _e24;
            some = false;
            {
                Vol_in_Node _e29 = node_11;
                Vol_in_Node _e30 = next_2;
                float _e31 = vol_in_weigh(ray_32, 0u, comb_15, _e29, _e30);
                weights_2[0u] = _e31;
                Vol_in_Interior _e34 = ahead_3[0u];
                here[0u] = _e34;
                float _e37 = comb_15.own[0u];
                if ((_e37 < 0.0)) {
                    Vol_in_Node _e41 = next_2;
                    float _e42 = vol_in_middle_of(comb_15, _e41);
                    vec3 _e43 = vol_in_ray_at(ray_32, _e42);
                    Vol_in_Interior _e44 = vol_in_medium_interior(0u, _e43);
                    ahead_3[0u] = _e44;
                }
                bool _e45 = some;
                float _e47 = weights_2[0u];
                some = (_e45 || (_e47 > 0.0));
            }
            bool _e51 = some;
            if (_e51) {
                Vol_in_Glow _e52 = glow_1;
                int _e54 = node_11.number;
                Vol_in_Node _e55 = node_11;
                float _e56 = vol_in_middle_of(comb_15, _e55);
                Vol_in_Chunk _e57 = vol_in_node_chunk(ray_32, _e56, styled_3, weights_2, here);
                Vol_in_Glow _e58 = vol_in_gather(_e52, _e54, _e57);
                glow_1 = _e58;
            }
            vec3 _e60 = glow_1.transmittance;
            float _e61 = vol_in_largest(_e60);
            if ((_e61 < VOL_IN_STOP)) {
                break;
            }
        }
    }
    Vol_in_Glow _e68 = glow_1;
    return _e68;
}

Vol_in_Radiance vol_in_radiance(Vol_in_Ray ray_33) {
    vec3 behind = vec3(0.0);
    float end_9 = VOL_IN_FAR;
    float depth_3 = VOL_IN_NO_DEPTH;
    Vol_in_Contact _e1 = vol_in_trace(ray_33);
    vec3 _e3 = vol_in_word3_(VOL_IN_AT_BACKGROUND);
    behind = _e3;
    if (_e1.hit) {
        vec3 _e10 = vol_in_shade(ray_33, _e1);
        behind = _e10;
        end_9 = _e1.t;
        vec3 _e15 = vol_in_word3_(VOL_IN_AT_FORWARD);
        float _e16 = vol_in_dot3_(ray_33.direction, _e15);
        depth_3 = (_e1.t * _e16);
    }
    float _e18 = end_9;
    Vol_in_Glow _e19 = vol_in_march(ray_33, _e18);
    vec3 _e22 = behind;
    vec3 coarse = (_e19.coarse_light + (_e19.coarse_transmittance * _e22));
    vec3 _e27 = behind;
    vec3 color_2 = (_e19.light + (_e19.transmittance * _e27));
    float _e31 = vol_in_length3_((coarse - color_2));
    float doubt = (_e31 * VOL_IN_ROOT_THIRD);
    float _e39 = depth_3;
    return Vol_in_Radiance(color_2, (_e1.hit ? vec3(0.0) : _e19.transmittance), _e39, doubt);
}

vec2 vol_in_place_in_pixel(uint index_19) {
    uint step_7 = ((index_19 + 1u) / 2u);
    uint signed = (((index_19 % 2u) == 1u) ? step_7 : (0u - step_7));
    uvec2 place_11 = (((uvec2(signed) * VOL_IN_STRIDE) + uvec2(2147483648u)) >> uvec2(16u));
    return (vec2(place_11) * 1.5258789e-5);
}

Vol_in_Ray vol_in_camera_ray(vec2 place_3) {
    float _e5 = vol_frame_word(VOL_IN_AT_SIZE);
    float u_5 = (((2.0 * place_3.x) / _e5) - 1.0);
    float _e13 = vol_frame_word(5u);
    float v_8 = (1.0 - ((2.0 * place_3.y) / _e13));
    vec3 _e18 = vol_in_word3_(VOL_IN_AT_FORWARD);
    vec3 _e20 = vol_in_word3_(VOL_IN_AT_RIGHT);
    vec3 sideways = (_e18 + (_e20 * u_5));
    vec3 _e24 = vol_in_word3_(VOL_IN_AT_UP);
    vec3 toward_4 = (sideways + (_e24 * v_8));
    vec3 _e28 = vol_in_word3_(VOL_IN_AT_EYE);
    float _e29 = vol_in_length3_(toward_4);
    Vol_in_Ray _e32 = vol_in_new_ray(_e28, (toward_4 / vec3(_e29)));
    return _e32;
}

float vol_in_comb_shift(uvec2 pixel, uint index_20) {
    uint place_12 = (((pixel.x * 3242174889u) + (pixel.y * 2447445414u)) + (index_20 * VOL_IN_GOLDEN_STRIDE));
    return ((float(((place_12 + 2147483648u) >> 16u)) * 1.5258789e-5) - 0.5);
}

Vol_in_Ray vol_in_pixel_ray(uvec2 pixel_1, uint index_21, uint corner) {
    Vol_in_Ray ray_34 = Vol_in_Ray(vec3(0.0), vec3(0.0), 0.0);
    bool is_probe = (corner < VOL_IN_NO_CORNER);
    vec2 _e5 = vol_in_place_in_pixel(index_21);
    vec2 aside_2 = (is_probe ? vec2(uvec2((corner % 2u), (corner / 2u))) : _e5);
    Vol_in_Ray _e15 = vol_in_camera_ray((vec2(pixel_1) + aside_2));
    ray_34 = _e15;
    float _e18 = vol_in_comb_shift(pixel_1, index_21);
    ray_34.shift = (is_probe ? 0.0 : _e18);
    Vol_in_Ray _e21 = ray_34;
    return _e21;
}

Vol_in_Mean vol_in_add_probe(Vol_in_Mean old, Vol_in_Radiance probe) {
    Vol_in_Mean mean_2 = Vol_in_Mean(0u, vec3(0.0), vec3(0.0), 0.0, 0.0, 0.0, 0.0);
    mean_2 = old;
    vec3 _e5 = mean_2.color;
    vec3 color_3 = (probe.color - _e5);
    float _e9 = mean_2.color_spread;
    float _e10 = vol_in_dot3_(color_3, color_3);
    mean_2.color_spread = (_e9 + _e10);
    vec3 _e14 = mean_2.transmittance;
    vec3 transmittance_1 = (probe.transmittance - _e14);
    float _e18 = mean_2.transmittance_spread;
    float _e19 = vol_in_dot3_(transmittance_1, transmittance_1);
    mean_2.transmittance_spread = (_e18 + _e19);
    Vol_in_Mean _e21 = mean_2;
    return _e21;
}

Vol_in_Mean vol_in_add_sample(Vol_in_Mean old_1, Vol_in_Radiance sample_) {
    Vol_in_Mean mean_3 = Vol_in_Mean(0u, vec3(0.0), vec3(0.0), 0.0, 0.0, 0.0, 0.0);
    mean_3 = old_1;
    uint _e4 = mean_3.count;
    mean_3.count = (_e4 + 1u);
    uint _e8 = mean_3.count;
    if ((_e8 == 1u)) {
        mean_3.color = sample_.color;
        mean_3.transmittance = sample_.transmittance;
        mean_3.depth = sample_.depth;
        mean_3.doubt = sample_.doubt;
        Vol_in_Mean _e19 = mean_3;
        return _e19;
    }
    uint _e21 = mean_3.count;
    float share_1 = (1.0 / float(_e21));
    float _e27 = mean_3.doubt;
    float _e30 = mean_3.doubt;
    mean_3.doubt = (_e27 + ((sample_.doubt - _e30) * share_1));
    vec3 _e36 = mean_3.color;
    vec3 color_4 = (sample_.color - _e36);
    vec3 _e40 = mean_3.color;
    mean_3.color = (_e40 + (color_4 * share_1));
    float _e45 = mean_3.color_spread;
    vec3 _e48 = mean_3.color;
    float _e50 = vol_in_dot3_(color_4, (sample_.color - _e48));
    mean_3.color_spread = (_e45 + _e50);
    vec3 _e54 = mean_3.transmittance;
    vec3 transmittance_2 = (sample_.transmittance - _e54);
    vec3 _e58 = mean_3.transmittance;
    mean_3.transmittance = (_e58 + (transmittance_2 * share_1));
    vec3 _e63 = mean_3.transmittance;
    vec3 from_new = (sample_.transmittance - _e63);
    float _e67 = mean_3.transmittance_spread;
    float _e68 = vol_in_dot3_(transmittance_2, from_new);
    mean_3.transmittance_spread = (_e67 + _e68);
    Vol_in_Mean _e70 = mean_3;
    return _e70;
}

bool vol_in_is_probed() {
    bool local_10 = false;
    float _e1 = vol_frame_word(VOL_IN_AT_TOLERANCE);
    if ((_e1 > 0.0)) {
        float _e7 = vol_frame_word(VOL_IN_AT_SAMPLES);
        local_10 = (uint(_e7) > VOL_IN_FIRST_ROUND);
    } else {
        local_10 = false;
    }
    bool _e12 = local_10;
    return _e12;
}

Vol_in_Mean vol_in_sample_pixel(uvec2 pixel_2, Vol_in_Mean before_6, uint last_3) {
    Vol_in_Mean mean_4 = Vol_in_Mean(0u, vec3(0.0), vec3(0.0), 0.0, 0.0, 0.0, 0.0);
    uint corner_1 = VOL_IN_NO_CORNER;
    bool local_11 = false;
    bool local_12 = false;
    bool local_13 = false;
    mean_4 = before_6;
    while(true) {
        uint _e6 = corner_1;
        if (!((_e6 < VOL_IN_NO_CORNER))) {
            uint _e13 = mean_4.count;
            if ((_e13 < last_3)) {
                Vol_in_Mean _e17 = mean_4;
                bool _e18 = vol_in_is_done(_e17);
                local_12 = !(_e18);
            } else {
                local_12 = false;
            }
            bool _e21 = local_12;
            local_11 = _e21;
        } else {
            local_11 = true;
        }
        bool _e23 = local_11;
        if (_e23) {
        } else {
            break;
        }
        {
            uint _e24 = corner_1;
            bool is_probe_1 = (_e24 < VOL_IN_NO_CORNER);
            uint _e28 = mean_4.count;
            uint _e29 = corner_1;
            Vol_in_Ray _e30 = vol_in_pixel_ray(pixel_2, _e28, _e29);
            Vol_in_Radiance _e31 = vol_in_radiance(_e30);
            if (is_probe_1) {
                Vol_in_Mean _e32 = mean_4;
                Vol_in_Mean _e33 = vol_in_add_probe(_e32, _e31);
                mean_4 = _e33;
                uint _e34 = corner_1;
                corner_1 = (_e34 + 1u);
            } else {
                Vol_in_Mean _e37 = mean_4;
                Vol_in_Mean _e38 = vol_in_add_sample(_e37, _e31);
                mean_4 = _e38;
                bool _e41 = vol_in_is_probed();
                if (_e41) {
                    uint _e45 = mean_4.count;
                    local_13 = (_e45 == VOL_IN_FIRST_ROUND);
                } else {
                    local_13 = false;
                }
                bool _e49 = local_13;
                corner_1 = (_e49 ? 0u : VOL_IN_NO_CORNER);
            }
        }
    }
    Vol_in_Mean _e51 = mean_4;
    return _e51;
}

float vol_distance(vec3 p_23) {
    float nearest = VOL_IN_FAR;
    float _e3 = nearest;
    return _e3;
}

float vol_density(vec3 p_24) {
    float sum_4 = 0.0;
    float _e3 = sum_4;
    float _e7 = vol_f7_density_cloud(p_24.x, p_24.y, p_24.z);
    sum_4 = (_e3 + max(_e7, 0.0));
    float _e11 = sum_4;
    return _e11;
}

vec4 vol_radiance(vec3 origin_1, vec3 direction_4) {
    float _e2 = vol_in_length3_(direction_4);
    Vol_in_Ray _e5 = vol_in_new_ray(origin_1, (direction_4 / vec3(_e2)));
    Vol_in_Radiance _e6 = vol_in_radiance(_e5);
    vec3 t_35 = _e6.transmittance;
    float clear_3 = (((t_35.x + t_35.y) + t_35.z) * 0.33333334);
    return vec4(_e6.color, (1.0 - clear_3));
}

vec4 vol_pixel(vec2 place_4) {
    Vol_in_Ray _e1 = vol_in_camera_ray(place_4);
    Vol_in_Radiance _e2 = vol_in_radiance(_e1);
    vec3 t_36 = _e2.transmittance;
    float clear_4 = (((t_36.x + t_36.y) + t_36.z) * 0.33333334);
    return vec4(_e2.color, (1.0 - clear_4));
}

float vol_distance_cloud(vec3 p_25) {
    float _e4 = vol_f2_region_cloud(p_25.x, p_25.y, p_25.z);
    return _e4;
}

float vol_density_cloud(vec3 p_26) {
    float _e4 = vol_f7_density_cloud(p_26.x, p_26.y, p_26.z);
    return _e4;
}

vec3 vol_colour_cloud(vec3 p_27) {
    vec3 _e4 = vol_f8_colour_cloud(p_27.x, p_27.y, p_27.z);
    return _e4;
}

vec3 vol_local_cloud(vec3 p_28) {
    vec3 _e4 = vol_f9_local_cloud(p_28.x, p_28.y, p_28.z);
    return _e4;
}

