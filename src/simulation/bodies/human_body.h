// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "radar_dot/simulation/mesh.h"

namespace radar_dot::simulation {

/// Measures of a person, m.
struct Physique {
  float height = 1.75F;
  float girth = 1.0F;  ///< 1 = slim
  float thigh = 0.43F;
  float shank = 0.42F;
  float ankle_height = 0.08F;
  float upper_arm = 0.3F;
  float forearm = 0.26F;
  float torso = 0.5F;  ///< hips to shoulders
  float hip_half = 0.085F;
  float shoulder_half = 0.19F;

  float hipHeight() const { return thigh + shank + ankle_height; }
  float shoulderHeight() const { return hipHeight() + torso; }
};
Physique physiqueOf(float height, float girth);

enum class Garment { kJacket, kCoat, kDress };
enum class HeadWear { kShortHair, kLongHair, kCap, kHelmet };

/// Hips to neck, with the hips' middle at the origin. Palette: coat 0, trousers 1.
void addTorso(MeshBuilder& builder, const Physique& body, Garment garment);
/// Neck and head, with the middle between the shoulders at the origin. Palette: skin 2, hair 3.
void addHead(MeshBuilder& builder, const Physique& body, HeadWear wear);
/// Limbs hang down from their joint at the origin.
void addThigh(MeshBuilder& builder, const Physique& body, bool bare);
void addShank(MeshBuilder& builder, const Physique& body, bool bare);
void addFoot(MeshBuilder& builder, const Physique& body);
void addUpperArm(MeshBuilder& builder, const Physique& body);
void addForearm(MeshBuilder& builder, const Physique& body);  ///< with the hand

}  // namespace radar_dot::simulation
