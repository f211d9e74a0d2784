#include "engine/em/radio_material.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <string>

#include <nlohmann/json.hpp>

#include "engine/base/constants.h"
#include "engine/em/slab.h"
#include "tests/support/golden.h"

namespace rayloc::radio_material_test {
namespace {

using nlohmann::json;

json reference() { return test::golden("room_cases"); }

void expect_same(const Complex<double>& value, const json& expected) {
  EXPECT_NEAR(value.re, expected.at(0), 1e-12);
  EXPECT_NEAR(value.im, expected.at(1), 1e-12);
}

TEST(RadioMaterial, ItuValuesMatchTheReference) {
  const json doc = reference();
  for (const auto& [name, expected] : doc.at("itu_p2040_3").items()) {
    const auto material = itu_material(name, doc.at("frequency"));
    ASSERT_TRUE(material) << name;
    EXPECT_NEAR(material->relative_permittivity, expected.at("eps_r"), 1e-12);
    const double sigma = expected.at("sigma");
    EXPECT_NEAR(material->conductivity, sigma, 1e-12 * std::max(1.0, sigma));
    EXPECT_EQ(material->thickness, 0.1);
    const double eta_im = expected.at("eta").at(1);
    EXPECT_NEAR(complex_permittivity(*material, doc.at("frequency")).im,
                eta_im,
                1e-12 * std::max(1.0, std::abs(eta_im)));
  }
}

TEST(RadioMaterial, SlabsMatchTheReference) {
  const json doc = reference();
  const double frequency = doc.at("frequency");
  for (const json& row : doc.at("slab")) {
    SCOPED_TRACE(row.at("material").dump() + row.at("deg").dump());
    const auto material = itu_material(row.at("material").get<std::string>(), frequency);
    ASSERT_TRUE(material);
    const double angle = row.at("deg").get<double>() * std::numbers::pi / 180.0;
    const auto slab = slab_coefficients<double>(std::cos(angle),
                                                complex_permittivity(*material, frequency),
                                                row.at("thickness"),
                                                kSpeedOfLight / frequency);
    expect_same(slab.r_te, row.at("r_te"));
    expect_same(slab.r_tm, row.at("r_tm"));
    expect_same(slab.t_te, row.at("t_te"));
    expect_same(slab.t_tm, row.at("t_tm"));
  }
}

// The documented example of Sionna RT: eps_r 2.1, 0.1 S/m, 20 cm, 3.5 GHz, 6 m apart.
TEST(RadioMaterial, PublishedSlabIsReproduced) {
  const double frequency = 3.5e9;
  const double wavelength = kSpeedOfLight / frequency;
  const RadioMaterial material{"slab", 2.1, 0.1, 0.2};
  const auto slab = slab_coefficients<double>(
      1.0, complex_permittivity(material, frequency), material.thickness, wavelength);
  const double free_space = wavelength / (4.0 * std::numbers::pi * 6.0);
  const double level = 20.0 * std::log10(std::sqrt(abs2(slab.t_te)) * free_space);
  EXPECT_NEAR(level, -81.59713, 1e-5);     // as published, computed in single precision
  EXPECT_NEAR(level, -81.59712324, 1e-8);  // the same formula in double, independently
}

TEST(RadioMaterial, ThickLossySlabIsAHalfSpace) {
  const Complex<double> concrete{5.24, -0.58};
  const auto slab = slab_coefficients<double>(0.4, concrete, 50.0, 0.058);
  const auto half_space = half_space_coefficients<double>(0.4, concrete);
  EXPECT_NEAR(abs2(slab.r_te - half_space.r_te), 0.0, 1e-24);
  EXPECT_NEAR(abs2(slab.r_tm - half_space.r_tm), 0.0, 1e-24);
}

// At Brewster's angle a lossless half space does not reflect the parallel part.
TEST(RadioMaterial, HalfSpaceHasABrewsterAngle) {
  const double permittivity = 5.24;
  const double cos_brewster = 1.0 / std::sqrt(1.0 + permittivity);
  const auto r = half_space_coefficients<double>(cos_brewster, {permittivity, 0.0});
  EXPECT_NEAR(abs2(r.r_tm), 0.0, 1e-30);
  EXPECT_GT(abs2(r.r_te), 0.1);
}

TEST(RadioMaterial, UnknownNameGetsASuggestion) {
  const auto material = itu_material("concret", 5.2e9);
  ASSERT_FALSE(material);
  EXPECT_EQ(material.error().message,
            "ITU-R P.2040-4 has no material 'concret'; did you mean 'concrete'?");
}

TEST(RadioMaterial, FrequencyOutsideTheTableIsRefused) {
  const auto ground = itu_material("wet_ground", 60e9);
  ASSERT_FALSE(ground);
  EXPECT_EQ(ground.error().message,
            "ITU-R P.2040-4 states 'wet_ground' for 1 to 10 GHz, not for 60 GHz; state "
            "relative_permittivity and conductivity instead");
  const auto glass = itu_material("glass", 150e9);
  ASSERT_FALSE(glass);
  EXPECT_NE(glass.error().message.find("0.1 to 100 GHz and 220 to 450 GHz"), std::string::npos);
  EXPECT_EQ(itu_material("glass", 300e9)->relative_permittivity, 5.79);
}

TEST(Field, MaterialsOfTheFourthEditionAreInTheTable) {
  constexpr double kFrequency = 5.18e9;
  const auto vinyl = itu_material("vinyl_tile", kFrequency);
  ASSERT_TRUE(vinyl);
  EXPECT_EQ(vinyl->relative_permittivity, 3.62);
  EXPECT_NEAR(vinyl->conductivity, 0.0051 * std::pow(5.18, 0.8422), 1e-15);
  EXPECT_EQ(itu_material("carpet_tile", kFrequency)->relative_permittivity, 2.08);
  EXPECT_EQ(itu_material("asphalt_concrete", kFrequency)->relative_permittivity, 4.83);
  EXPECT_EQ(itu_material("clear_acrylic", 200e9)->relative_permittivity, 2.58);
  // Not defined below 110 GHz: an error, and no value of another band.
  const auto acrylic = itu_material("clear_acrylic", kFrequency);
  ASSERT_FALSE(acrylic);
  EXPECT_NE(acrylic.error().message.find("110 to 330 GHz"), std::string::npos);
}

TEST(RadioMaterial, UnphysicalValuesAreRefused) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_TRUE(validate({"half space", 3.0, 0.0, kHalfSpace}));
  EXPECT_FALSE(validate({"m", 0.5, 0.0, 0.1}));
  EXPECT_FALSE(validate({"m", nan, 0.0, 0.1}));
  EXPECT_FALSE(validate({"m", 3.0, -1.0, 0.1}));
  EXPECT_FALSE(validate({"m", 3.0, nan, 0.1}));
  EXPECT_FALSE(validate({"m", 3.0, 0.0, 0.0}));
  EXPECT_EQ(validate({"m", 3.0, 0.0, nan}).error().message,
            "material 'm': thickness is nan, must be more than 0 [m]");
}

}  // namespace
}  // namespace rayloc::radio_material_test
