#ifndef BREAKAWAY_HELPERS_H
#define BREAKAWAY_HELPERS_H

#include <stdint.h>

/* sin of an angle in turns: Taylor to the 11th power within a quarter turn, error 3e-7. For |turns| < 2^31. */
static inline float bk_sin_turns(float turns) {
    float r = turns - (float)(int32_t)(turns + (turns < 0.0f ? -0.5f : 0.5f));
    r = r > 0.25f ? 0.5f - r : (r < -0.25f ? -0.5f - r : r);
    float q = r * r;
    return r * (6.2831855f + q * (-41.3417f + q * (81.60525f + q * (-76.70586f + q * (42.058693f + q * -15.094643f)))));
}

/* e^-y for y >= 0; 0 from y = 20 on. Error 3e-6 of the result. */
static inline float bk_exp_negative(float y) {
    if (!(y < 20.0f)) { return 0.0f; }
    float t = y * 1.44269504f;
    int32_t k = (int32_t)t;
    float f = (t - (float)k) * 0.69314718f;
    float r = 1.0f - f * (1.0f - f * (0.5f - f * (0.16666667f - f * (0.041666667f - f * (8.3333333e-3f
        - f * (1.3888889e-3f - f * 1.984127e-4f))))));
    while (k-- > 0) { r *= 0.5f; }
    return r;
}

/* r^p for r > 0, through log2 bit by bit. */
static inline float bk_power(float r, float p) {
    float log2 = 0.0f;
    while (r >= 2.0f) { r *= 0.5f; log2 += 1.0f; }
    while (r < 1.0f) { r *= 2.0f; log2 -= 1.0f; }
    for (float bit = 0.5f; bit > 1e-7f; bit *= 0.5f) {
        r *= r;
        if (r >= 2.0f) { r *= 0.5f; log2 += bit; }
    }
    float y = p * log2 * 0.69314718f;
    return y > 0.0f ? 1.0f / bk_exp_negative(y > 8.0f ? 8.0f : y) : bk_exp_negative(-y);
}

/* Fixed point: Q16.16, saturated. A constant is m * 2^-s with m below 2^30, so that small ones keep their digits. */
static inline int32_t bk_sat(int64_t value) {
    return value > INT32_MAX ? INT32_MAX : (value < -INT32_MAX ? -INT32_MAX : (int32_t)value);
}

/* value * m * 2^-s, rounded; for |value| < 2^32. */
static inline int64_t bk_mul(int64_t value, int32_t m, int s) {
    if (s > 61) { return 0; }
    int64_t product = value * m;
    return s > 0 ? (product + ((int64_t)1 << (s - 1))) >> s : product;
}

/* sin of a phase in 2^-32 turns, in 2^-30: odd polynomial of the quarter turn, error 5e-8. */
static inline int32_t bk_sin_phase(uint32_t phase) {
    int64_t z = (int32_t)phase;
    z = z > (1 << 30) ? (int64_t)2147483648 - z : (z < -(1 << 30) ? -(int64_t)2147483648 - z : z);
    int64_t q = (z * z) >> 30;
    int64_t r = -3864;
    r = 172272 + ((r * q) >> 30);
    r = -5026979 + ((r * q) >> 30);
    r = 85569306 + ((r * q) >> 30);
    r = -693598668 + ((r * q) >> 30);
    r = 1686629713 + ((r * q) >> 30);
    r = (r * z) >> 30;
    return (int32_t)(r > (1 << 30) ? (1 << 30) : (r < -(1 << 30) ? -(1 << 30) : r));
}

/* 2^-t of a t >= 0 in Q16.16, in 2^-30. */
static inline int32_t bk_exp2_negative(int64_t t) {
    if (t >= ((int64_t)31 << 16)) { return 0; }
    int64_t f = ((t & 0xffff) * 744261118) >> 16; /* ln 2 of the fraction, in 2^-30 */
    int64_t one = (int64_t)1 << 30, r = one;
    for (int n = 8; n > 0; n--) { r = one - (((f * r) >> 30) / n); }
    return (int32_t)(r >> (t >> 16));
}

/* e^-y of a y >= 0 in Q16.16, in 2^-30. */
static inline int32_t bk_exp_negative_q16(int64_t y) {
    if (y > ((int64_t)20 << 16)) { return 0; }
    return bk_exp2_negative((y * 1549082005 + (1 << 29)) >> 30);
}

/* r^p of r > 0 in Q16.16, with p in Q16.16; at most 2^12. */
static inline int64_t bk_power_q16(int64_t r, int32_t p) {
    int64_t m = r << 14, log2 = 0; /* in 2^-30 */
    while (m >= ((int64_t)2 << 30)) { m >>= 1; log2 += 65536; }
    while (m < ((int64_t)1 << 30)) { m <<= 1; log2 -= 65536; }
    for (int32_t bit = 32768; bit > 0; bit >>= 1) {
        m = (m * m) >> 30;
        if (m >= ((int64_t)2 << 30)) { m >>= 1; log2 += bit; }
    }
    int64_t w = (log2 * p) >> 16;
    if (w > (12 << 16)) { w = 12 << 16; }
    if (w <= 0) { return bk_exp2_negative(-w) >> 14; }
    int64_t whole = (w + 65535) >> 16;
    return ((int64_t)bk_exp2_negative((whole << 16) - w) << whole) >> 14;
}

#endif
