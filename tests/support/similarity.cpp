// tests/support/similarity.cpp
#include "tests/support/similarity.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <map>

namespace sigmaflow::test {
namespace {

constexpr int window = 8, stride = 4;

double window_similarity(const render::Image& a, const render::Image& b, int left, int top,
                         int channel)
{
    constexpr double count = window * window;
    constexpr double c1 = (0.01 * 255) * (0.01 * 255), c2 = (0.03 * 255) * (0.03 * 255);
    double sum_a = 0, sum_b = 0, sum_aa = 0, sum_bb = 0, sum_ab = 0;
    for (int y = top; y < top + window; ++y) {
        for (int x = left; x < left + window; ++x) {
            const double p = a.pixel(x, y)[channel], q = b.pixel(x, y)[channel];
            sum_a += p;
            sum_b += q;
            sum_aa += p * p;
            sum_bb += q * q;
            sum_ab += p * q;
        }
    }
    const double mean_a = sum_a / count, mean_b = sum_b / count;
    const double variance_a = sum_aa / count - mean_a * mean_a;
    const double variance_b = sum_bb / count - mean_b * mean_b;
    const double covariance = sum_ab / count - mean_a * mean_b;
    return (2 * mean_a * mean_b + c1) * (2 * covariance + c2) /
           ((mean_a * mean_a + mean_b * mean_b + c1) * (variance_a + variance_b + c2));
}

}

double similarity(const render::Image& a, const render::Image& b)
{
    double sum = 0;
    long windows = 0;
    for (int channel = 0; channel < 3; ++channel) {
        for (int y = 0; y + window <= a.height; y += stride) {
            for (int x = 0; x + window <= a.width; x += stride) {
                sum += window_similarity(a, b, x, y, channel);
                ++windows;
            }
        }
    }
    return sum / windows;
}

int largest_difference(const render::Image& a, const render::Image& b)
{
    int largest = 0;
    for (std::size_t i = 0; i < a.rgb.size(); ++i)
        largest = std::max(largest, std::abs(int(a.rgb[i]) - int(b.rgb[i])));
    return largest;
}

double drawn_share(const render::Image& image)
{
    std::map<std::array<std::uint8_t, 3>, long> counts;
    long most = 0;
    for (std::size_t k = 0; k + 2 < image.rgb.size(); k += 3)
        most = std::max(most, ++counts[{image.rgb[k], image.rgb[k + 1], image.rgb[k + 2]}]);
    const double all = static_cast<double>(image.rgb.size()) / 3;
    return all > 0 ? 1 - static_cast<double>(most) / all : 0;
}

}
