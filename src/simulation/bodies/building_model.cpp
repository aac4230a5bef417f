// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>

#include "simulation/bodies/building_front.h"
#include "simulation/bodies/building_style.h"
#include "simulation/bodies/make_models.h"
#include "simulation/bodies/shapes.h"

namespace radar_dot::simulation {
namespace {

using Eigen::Vector3f;

class House {
 public:
  House(const Facade& facade, const BuildingStyle& style, RandomStream& random)
      : style_(style),
        random_(random),
        front_(builder_, style_.frame),
        storeys_(std::max(1, facade.storeys)),
        shop_(facade.shop),
        width_(static_cast<float>(facade.width)),
        depth_(static_cast<float>(facade.depth)) {
    bays_ =
        std::max(1, static_cast<int>((width_ - 0.6F) / (style_.window_width + uniform(random, 0.9F, 1.5F))));
    bay_width_ = width_ / static_cast<float>(bays_);
    wall_top_ = style_.ground_storey + style_.storey * static_cast<float>(storeys_ - 1) + 0.35F;
  }

  std::shared_ptr<const Mesh> build() && {
    groundFloor();
    for (int storey = 1; storey < storeys_; ++storey) upperFloor(storey);
    builder_.use(style_.wall);
    front_.wall({0.0F, width_, wall_top_ - 0.35F, wall_top_});
    otherSides();
    if (style_.pitched)
      pitchedRoof();
    else
      flatRoof();
    cornice();
    downpipes();
    return share(std::move(builder_));
  }

 private:
  Opening bay(int number, float bottom, float top) const {
    return {bay_width_ * static_cast<float>(number), bay_width_ * static_cast<float>(number + 1), bottom,
            top};
  }
  Opening windowIn(const Opening& bay, float sill, float height, float width) const {
    const float middle = 0.5F * (bay.left + bay.right);
    return {middle - 0.5F * width, middle + 0.5F * width, bay.bottom + sill, bay.bottom + sill + height};
  }

  void window(const Opening& bay, float sill) {
    const Opening hole =
        windowIn(bay, sill, style_.window_height, std::min(style_.window_width, bay.width() - 0.3F));
    front_.wallAround(bay, hole, style_.wall, style_.setback);
    front_.glazing(hole, style_.pane, style_.setback, style_.mullions, style_.transom ? 0.7F : 0.0F);
    builder_.use(style_.trim);
    front_.block({hole.left - 0.08F, hole.right + 0.08F, hole.bottom - 0.09F, hole.bottom},
                 -style_.setback + 0.04F, 0.07F);
    if (style_.lintels)
      front_.block({hole.left - 0.1F, hole.right + 0.1F, hole.top, hole.top + 0.16F}, -0.02F, 0.03F);
  }

  void balcony(const Opening& bay) {
    const Opening hole =
        windowIn(bay, 0.12F, 2.25F, std::min(style_.window_width + 0.1F, bay.width() - 0.3F));
    front_.wallAround(bay, hole, style_.wall, style_.setback);
    front_.glazing(hole, style_.pane, style_.setback, 1, 0.0F);
    const float left = hole.left - 0.3F;
    const float right = hole.right + 0.3F;
    constexpr float kReach = 0.95F;
    const float floor = bay.bottom + 0.1F;
    builder_.use(style_.trim);
    front_.block({left, right, floor - 0.16F, floor}, 0.0F, kReach);
    builder_.use(plain(Material::kPaintedMetal, 0.03F));
    const float rail = floor + 1.0F;
    front_.block({left, right, rail, rail + 0.04F}, kReach - 0.05F, kReach);
    for (const float x : {left, right - 0.04F})
      front_.block({x, x + 0.04F, rail, rail + 0.04F}, 0.0F, kReach - 0.05F);
    for (float x = left; x < right; x += 0.14F)
      front_.block({x, x + 0.018F, floor, rail}, kReach - 0.035F, kReach - 0.017F);
    for (float y = 0.12F; y < kReach - 0.1F; y += 0.16F)
      for (const float x : {left, right - 0.018F}) front_.block({x, x + 0.018F, floor, rail}, y, y + 0.018F);
  }

  void upperFloor(int storey) {
    const float bottom = style_.ground_storey + style_.storey * static_cast<float>(storey - 1);
    for (int number = 0; number < bays_; ++number) {
      const Opening area = bay(number, bottom, bottom + style_.storey);
      const bool with_balcony =
          style_.balconies > 0.0F && (number % 3) == 1 && area.width() > style_.window_width + 0.8F;
      if (with_balcony)
        balcony(area);
      else
        window(area, style_.sill);
    }
    if (!style_.bands && !(storey == 1)) return;
    builder_.use(style_.trim);
    front_.block({0.0F, width_, bottom - 0.1F, bottom + 0.06F}, -0.02F, 0.05F);
  }

  void door(const Opening& area) {
    const Opening hole = windowIn(area, 0.0F, 2.7F, std::min(1.15F, area.width() - 0.2F));
    front_.wallAround(area, hole, style_.wall, 0.3F);
    builder_.use(style_.door);
    const Opening leaf{hole.left, hole.right, hole.bottom, hole.bottom + 2.15F};
    front_.sheet(leaf, -0.3F);
    const float middle = 0.5F * (hole.left + hole.right);
    for (const float z : {0.2F, 1.15F})
      for (const float x : {hole.left + 0.12F, middle + 0.06F})
        front_.block({x, x + 0.5F * hole.width() - 0.18F, z, z + 0.8F}, -0.3F, -0.275F);
    front_.glazing({hole.left, hole.right, hole.bottom + 2.15F, hole.top}, style_.pane, 0.3F, 1, 0.0F);
    builder_.use(plain(Material::kChrome, 0.5F));
    front_.block({middle + 0.03F, middle + 0.06F, 0.98F, 1.12F}, -0.3F, -0.24F);
    builder_.use(style_.trim);
    front_.block({hole.left - 0.14F, hole.left, 0.0F, hole.top + 0.14F}, -0.02F, 0.05F);
    front_.block({hole.right, hole.right + 0.14F, 0.0F, hole.top + 0.14F}, -0.02F, 0.05F);
    front_.block({hole.left, hole.right, hole.top, hole.top + 0.14F}, -0.02F, 0.05F);
    front_.block({hole.left - 0.1F, hole.right + 0.1F, 0.0F, 0.12F}, -0.3F, 0.3F);
  }

  void shopBay(const Opening& area) {
    const float fascia = area.top - 0.75F;
    const Opening hole{area.left + 0.22F, area.right - 0.22F, 0.45F, fascia};
    front_.wallAround(area, hole, style_.plinth, 0.2F);
    front_.glazing(hole, plain(Material::kShopWindow, 0.06F), 0.2F, area.width() > 2.6F ? 1 : 0, 0.82F);
    if (!style_.awnings) return;
    constexpr float kReach = 1.15F;
    builder_.use(style_.awning);
    const float left = area.left + 0.1F;
    const float right = area.right - 0.1F;
    const float high = fascia + 0.05F;
    const float low = high - 0.5F;
    const auto sheet = [&](const Vector3f& a, const Vector3f& b, const Vector3f& c, const Vector3f& d) {
      builder_.quad(a, b, c, d);
      builder_.quad(d - Vector3f(0, 0, 0.01F), c - Vector3f(0, 0, 0.01F), b - Vector3f(0, 0, 0.01F),
                    a - Vector3f(0, 0, 0.01F));
    };
    sheet({left, 0.02F, high}, {right, 0.02F, high}, {right, kReach, low}, {left, kReach, low});
    builder_.use(plain(Material::kCloth, 0.6F, 0.58F, 0.5F));
    front_.block({left, right, low - 0.22F, low}, kReach - 0.012F, kReach);
  }

  void groundFloor() {
    const int door_bay = bays_ / 2;
    const float top = style_.ground_storey;
    for (int number = 0; number < bays_; ++number) {
      const Opening area = bay(number, 0.0F, top);
      if (number == door_bay)
        door(area);
      else if (shop_)
        shopBay(area);
      else
        window(area, 1.15F);
    }
    if (shop_) {
      builder_.use(style_.sign);
      front_.block({0.1F, width_ - 0.1F, top - 0.68F, top - 0.12F}, 0.0F, 0.09F);
      letters(top - 0.55F);
      return;
    }
    builder_.use(style_.plinth);
    for (int number = 0; number < bays_; ++number)
      if (number != door_bay) front_.block(bay(number, 0.0F, 0.55F), -0.02F, 0.04F);
  }

  /// A name of strokes: consonants and vowels take turns.
  void letters(float bottom) {
    // Strokes of a letter: left, right, top, middle, bottom.
    struct Letter {
      bool left, right, top, middle, bottom;
    };
    constexpr Letter kConsonants[] = {
        {1, 0, 1, 0, 1}, {1, 0, 1, 1, 0}, {1, 0, 0, 0, 1}, {1, 1, 0, 1, 0}};  // C F L H
    constexpr Letter kVowels[] = {
        {1, 1, 1, 1, 0}, {1, 0, 1, 1, 1}, {1, 1, 1, 0, 1}, {1, 1, 0, 0, 1}};  // A E O U
    constexpr float kStroke = 0.045F;
    constexpr float kWide = 0.19F;
    constexpr float kHigh = 0.3F;
    builder_.use(plain(Material::kPlastic, 0.75F, 0.73F, 0.66F));
    const int count = 4 + random_.index(4);
    const float start = width_ * uniform(random_, 0.5F, 0.8F);
    for (int number = 0; number < count; ++number) {
      const Letter& letter = number % 2 == 0 ? kConsonants[random_.index(4)] : kVowels[random_.index(4)];
      const float x = start - 0.27F * static_cast<float>(number);  // readers in the street read towards -x
      if (x - kWide < 0.2F) return;
      const auto stroke = [&](float from, float to, float low, float high) {
        front_.block({x - to, x - from, bottom + low, bottom + high}, 0.085F, 0.105F);
      };
      if (letter.left) stroke(0.0F, kStroke, 0.0F, kHigh);
      if (letter.right) stroke(kWide - kStroke, kWide, 0.0F, kHigh);
      if (letter.top) stroke(0.0F, kWide, kHigh - kStroke, kHigh);
      if (letter.middle) stroke(0.0F, kWide, 0.5F * (kHigh - kStroke), 0.5F * (kHigh + kStroke));
      if (letter.bottom) stroke(0.0F, kWide, 0.0F, kStroke);
    }
  }

  void otherSides() {
    builder_.use(style_.wall);
    const float top = wall_top_;
    builder_.quad({0, -depth_, 0}, {width_, -depth_, 0}, {width_, -depth_, top}, {0, -depth_, top});
    builder_.quad({0, 0, 0}, {0, -depth_, 0}, {0, -depth_, top}, {0, 0, top});
    builder_.quad({width_, -depth_, 0}, {width_, 0, 0}, {width_, 0, top}, {width_, -depth_, top});
  }

  void pitchedRoof() {
    const float ridge = wall_top_ + 0.36F * depth_;
    constexpr float kEaves = 0.35F;
    const float fall = kEaves * 0.72F;
    builder_.use(style_.roof);
    const float front = kEaves;
    const float back = -depth_ - kEaves;
    const float middle = -0.5F * depth_;
    const float low = wall_top_ - fall + 0.2F;
    builder_.quad({width_, front, low}, {0, front, low}, {0, middle, ridge + 0.2F},
                  {width_, middle, ridge + 0.2F});
    builder_.quad({0, back, low}, {width_, back, low}, {width_, middle, ridge + 0.2F},
                  {0, middle, ridge + 0.2F});
    builder_.use(style_.wall);
    builder_.triangle({0, 0, wall_top_}, {0, -depth_, wall_top_}, {0, middle, ridge + 0.19F});
    builder_.triangle({width_, -depth_, wall_top_}, {width_, 0, wall_top_}, {width_, middle, ridge + 0.19F});
    builder_.use(plain(Material::kPaintedMetal, 0.2F));
    builder_.cone({0, front + 0.03F, low - 0.02F}, {width_, front + 0.03F, low - 0.02F}, 0.07F, 0.07F, 8);
    chimneys(ridge);
    const int windows = bays_ / 2;
    for (int number = 0; number < windows; ++number)
      roofWindow((static_cast<float>(number) + 0.5F) * width_ / static_cast<float>(windows), low, front,
                 middle, ridge + 0.2F);
  }

  void roofWindow(float x, float low, float front, float middle, float high) {
    const Vector3f slope = Vector3f(0, middle - front, high - low).normalized();
    const Vector3f normal = Vector3f(0, high - low, front - middle).normalized();
    const Vector3f foot = Vector3f(x, front, low) + slope * 1.6F;
    const auto frame = [&](float half_width, float from, float to, float lift, const Surface& surface) {
      builder_.use(surface);
      const auto at = [&](float across, float up) {
        return Vector3f(foot + Vector3f(across, 0, 0) + slope * up + normal * lift);
      };
      builder_.quad(at(half_width, from), at(-half_width, from), at(-half_width, to), at(half_width, to));
    };
    frame(0.45F, 0.0F, 1.2F, 0.05F, plain(Material::kPaintedMetal, 0.1F));
    frame(0.37F, 0.08F, 1.12F, 0.07F, style_.pane);
  }

  void chimneys(float ridge) {
    for (const float share : {0.15F, 0.85F}) {
      builder_.use(plain(Material::kBrick, 0.3F, 0.12F, 0.08F));
      const Vector3f foot(share * width_, -0.5F * depth_ - 0.6F, ridge - 0.6F);
      builder_.box(foot - Vector3f(0.4F, 0.3F, 0), foot + Vector3f(0.4F, 0.3F, 1.9F));
      builder_.use(style_.trim);
      builder_.box(foot + Vector3f(-0.45F, -0.35F, 1.9F), foot + Vector3f(0.45F, 0.35F, 2.0F));
    }
  }

  void flatRoof() {
    builder_.use(style_.wall);
    builder_.box({0, -0.25F, wall_top_}, {width_, 0, wall_top_ + 0.5F});
    builder_.box({0, -depth_, wall_top_}, {0.25F, -0.25F, wall_top_ + 0.5F});
    builder_.box({width_ - 0.25F, -depth_, wall_top_}, {width_, -0.25F, wall_top_ + 0.5F});
    builder_.use(style_.roof);
    builder_.quad({0, -depth_, wall_top_ + 0.1F}, {width_, -depth_, wall_top_ + 0.1F},
                  {width_, 0, wall_top_ + 0.1F}, {0, 0, wall_top_ + 0.1F});
  }

  void cornice() {
    builder_.use(style_.trim);
    const float top = style_.pitched ? wall_top_ - 0.05F : wall_top_ + 0.5F;
    front_.block({0, width_, top - 0.12F, top}, -0.02F, 0.2F);
    front_.block({0, width_, top - 0.26F, top - 0.12F}, -0.02F, 0.12F);
    front_.block({0, width_, top - 0.36F, top - 0.26F}, -0.02F, 0.06F);
  }

  void downpipes() {
    builder_.use(plain(Material::kPaintedMetal, 0.2F));
    builder_.cone({width_ - 0.14F, 0.08F, 0.05F}, {width_ - 0.14F, 0.08F, wall_top_ - 0.2F}, 0.045F, 0.045F,
                  8);
  }

  BuildingStyle style_;
  RandomStream& random_;
  MeshBuilder builder_;
  BuildingFront front_;
  int storeys_;
  bool shop_;
  float width_, depth_;
  int bays_ = 1;
  float bay_width_ = 3.0F;
  float wall_top_ = 10.0F;
};

}  // namespace

std::shared_ptr<const Mesh> makeBuilding(const Facade& facade, RandomStream& random) {
  const BuildingStyle style = randomBuildingStyle(random);
  return House(facade, style, random).build();
}

}  // namespace radar_dot::simulation
