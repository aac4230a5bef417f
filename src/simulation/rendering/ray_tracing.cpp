// Copyright (c) 2026, the Radar-Dot developers
// SPDX-License-Identifier: BSD-3-Clause
#include "radar_dot/simulation/ray_tracing.h"

#include <embree3/rtcore.h>
#include <fmt/format.h>

#include <stdexcept>
#include <unordered_map>

namespace radar_dot::simulation {
namespace {

using Eigen::Vector3f;

constexpr double kVelocityStep = 1e-4;  // s

void check(RTCDevice device, const char* what) {
  const RTCError error = rtcGetDeviceError(device);
  if (error != RTC_ERROR_NONE)
    throw std::runtime_error(fmt::format("Embree: {} failed (error {})", what, static_cast<int>(error)));
}

/// Bottom level: one mesh.
RTCScene buildMeshScene(RTCDevice device, const Mesh& mesh) {
  const RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
  auto* positions = static_cast<float*>(rtcSetNewGeometryBuffer(
      geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, 3 * sizeof(float), mesh.positions.size()));
  auto* corners = static_cast<unsigned*>(rtcSetNewGeometryBuffer(
      geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, 3 * sizeof(unsigned), mesh.triangles.size()));
  check(device, "allocating a mesh");
  for (std::size_t i = 0; i < mesh.positions.size(); ++i)
    Eigen::Map<Vector3f>(positions + 3 * i) = mesh.positions[i];
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i)
    for (std::size_t k = 0; k < 3; ++k) corners[3 * i + k] = mesh.triangles[i].corners[k];
  rtcCommitGeometry(geometry);
  const RTCScene scene = rtcNewScene(device);
  rtcSetSceneFlags(scene, RTC_SCENE_FLAG_ROBUST);
  rtcAttachGeometry(scene, geometry);
  rtcReleaseGeometry(geometry);
  rtcCommitScene(scene);
  check(device, "building a mesh");
  return scene;
}

RTCRayHit makeRay(const Vector3f& origin, const Vector3f& direction, float near_m, float far_m) {
  RTCRayHit ray;
  ray.ray.org_x = origin.x();
  ray.ray.org_y = origin.y();
  ray.ray.org_z = origin.z();
  ray.ray.dir_x = direction.x();
  ray.ray.dir_y = direction.y();
  ray.ray.dir_z = direction.z();
  ray.ray.tnear = near_m;
  ray.ray.tfar = far_m;
  ray.ray.time = 0.0F;
  ray.ray.mask = 0xffffffffU;
  ray.ray.id = 0;
  ray.ray.flags = 0;
  ray.hit.geomID = RTC_INVALID_GEOMETRY_ID;
  ray.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
  return ray;
}

constexpr int kPacket = 8;

/// Ray number `i` of a packet.
void setRay(RTCRay8& rays, int i, const Vector3f& origin, const Vector3f& direction, float far_m) {
  rays.org_x[i] = origin.x();
  rays.org_y[i] = origin.y();
  rays.org_z[i] = origin.z();
  rays.dir_x[i] = direction.x();
  rays.dir_y[i] = direction.y();
  rays.dir_z[i] = direction.z();
  rays.tnear[i] = 0.0F;
  rays.tfar[i] = far_m;
  rays.time[i] = 0.0F;
  rays.mask[i] = 0xffffffffU;
  rays.id[i] = 0;
  rays.flags[i] = 0;
}

RTCIntersectContext newContext(RTCIntersectContextFlags flags) {
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  context.flags = flags;
  return context;
}

/// Towards the origin of the ray.
Vector3f facing(const Vector3f& normal, const Vector3f& direction) {
  const Vector3f unit = normal.normalized();
  return unit.dot(direction) > 0.0F ? Vector3f(-unit) : unit;
}

}  // namespace

struct RayGeometry::Data {
  RTCDevice device = nullptr;
  std::unordered_map<const Mesh*, RTCScene> scenes;

  void add(const Mesh* mesh) {
    if (mesh->triangles.empty() || scenes.count(mesh) > 0) return;
    scenes.emplace(mesh, buildMeshScene(device, *mesh));
  }
  ~Data() {
    for (const auto& [mesh, scene] : scenes) rtcReleaseScene(scene);
    if (device != nullptr) rtcReleaseDevice(device);
  }
};

RayGeometry::RayGeometry(const World& world) : data_(std::make_unique<Data>()) {
  data_->device = rtcNewDevice(nullptr);
  if (data_->device == nullptr) throw std::runtime_error("Embree: no device; is this CPU supported?");
  for (const StaticObject& object : world.statics) data_->add(object.mesh.get());
  for (const Actor& actor : world.actors)
    for (const Part& part : actor.model->parts) data_->add(part.mesh.get());
}

RayGeometry::~RayGeometry() = default;

struct Snapshot::Data {
  RTCScene scene = nullptr;
  std::vector<Eigen::Isometry3f> T_map_from_objects;

  ~Data() {
    if (scene != nullptr) rtcReleaseScene(scene);
  }

  /// @param normal  of the triangle, in the object's frame
  Hit hitOf(unsigned object, unsigned triangle, float u, float v, float distance, const Vector3f& normal,
            const Vector3f& direction) const {
    if (object == RTC_INVALID_GEOMETRY_ID) return {};
    return {distance, object, triangle,
            u,        v,      facing(T_map_from_objects[object].linear() * normal, direction)};
  }
  void place(RTCDevice device, RTCScene mesh_scene, std::uint32_t number,
             const Eigen::Isometry3d& pose) const {
    const RTCGeometry instance = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_INSTANCE);
    rtcSetGeometryInstancedScene(instance, mesh_scene);
    const Eigen::Matrix4f matrix = pose.matrix().cast<float>();
    rtcSetGeometryTransform(instance, 0, RTC_FORMAT_FLOAT4X4_COLUMN_MAJOR, matrix.data());
    rtcCommitGeometry(instance);
    rtcAttachGeometryByID(scene, instance, number);
    rtcReleaseGeometry(instance);
  }
};

Snapshot::Snapshot(const World& world, const RayGeometry& geometry, double time_s)
    : time_s_(time_s), data_(std::make_unique<Data>()) {
  for (const StaticObject& object : world.statics)
    objects_.push_back({object.mesh.get(), &object.palette, -1, -1, object.T_map_from_object,
                        Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero()});
  for (std::size_t number = 0; number < world.actors.size(); ++number) {
    const Actor& actor = world.actors[number];
    const auto posesAt = [&](double time) {
      const BodyState state = actor.trajectory->at(time);
      std::vector<Eigen::Isometry3d> poses = actor.model->T_body_from_parts(state);
      for (Eigen::Isometry3d& pose : poses) pose = state.T_map_from_body * pose;
      return poses;
    };
    const auto now = posesAt(time_s);
    const auto before = posesAt(time_s - kVelocityStep);
    const auto after = posesAt(time_s + kVelocityStep);
    for (std::size_t part = 0; part < now.size(); ++part) {
      const Eigen::Vector3d step = after[part].translation() - before[part].translation();
      objects_.push_back({actor.model->parts[part].mesh.get(), &actor.palette,
                          static_cast<std::int32_t>(number), static_cast<std::int32_t>(part), now[part],
                          step / (2.0 * kVelocityStep),
                          rotationRate(before[part], after[part], 2.0 * kVelocityStep)});
    }
  }
  const RTCDevice device = geometry.data_->device;
  data_->scene = rtcNewScene(device);
  rtcSetSceneFlags(data_->scene, RTC_SCENE_FLAG_ROBUST);
  for (std::size_t number = 0; number < objects_.size(); ++number) {
    const PlacedObject& object = objects_[number];
    data_->T_map_from_objects.push_back(object.T_map_from_object.cast<float>());
    const auto found = geometry.data_->scenes.find(object.mesh);
    if (found != geometry.data_->scenes.end())
      data_->place(device, found->second, static_cast<std::uint32_t>(number), object.T_map_from_object);
  }
  rtcCommitScene(data_->scene);
  check(device, "building a snapshot");
}

Snapshot::~Snapshot() = default;

Hit Snapshot::trace(const Vector3f& origin, const Vector3f& direction, float near_m, float far_m) const {
  RTCIntersectContext context = newContext(RTC_INTERSECT_CONTEXT_FLAG_INCOHERENT);
  RTCRayHit ray = makeRay(origin, direction, near_m, far_m);
  rtcIntersect1(data_->scene, &context, &ray);
  const RTCHit& hit = ray.hit;
  return data_->hitOf(hit.instID[0], hit.primID, hit.u, hit.v, ray.ray.tfar, {hit.Ng_x, hit.Ng_y, hit.Ng_z},
                      direction);
}

bool Snapshot::blocked(const Vector3f& origin, const Vector3f& direction, float near_m, float far_m) const {
  if (!(far_m > near_m)) return false;
  RTCIntersectContext context = newContext(RTC_INTERSECT_CONTEXT_FLAG_INCOHERENT);
  RTCRayHit ray = makeRay(origin, direction, near_m, far_m);
  rtcOccluded1(data_->scene, &context, &ray.ray);
  return ray.ray.tfar < 0.0F;
}

void Snapshot::trace8(const Vector3f& origin, const Vector3f* directions, int count, Hit* hits) const {
  RTCIntersectContext context = newContext(RTC_INTERSECT_CONTEXT_FLAG_COHERENT);
  alignas(32) int valid[kPacket];
  RTCRayHit8 rays;
  RTCHit8& hit = rays.hit;
  for (int i = 0; i < kPacket; ++i) {
    valid[i] = i < count ? -1 : 0;
    setRay(rays.ray, i, origin, directions[i < count ? i : 0], 1e30F);
    hit.geomID[i] = RTC_INVALID_GEOMETRY_ID;
    hit.instID[0][i] = RTC_INVALID_GEOMETRY_ID;
  }
  rtcIntersect8(valid, data_->scene, &context, &rays);
  for (int i = 0; i < count; ++i)
    hits[i] = data_->hitOf(hit.instID[0][i], hit.primID[i], hit.u[i], hit.v[i], rays.ray.tfar[i],
                           {hit.Ng_x[i], hit.Ng_y[i], hit.Ng_z[i]}, directions[i]);
}

void Snapshot::blocked8(const Vector3f* origins, const Vector3f* directions, const float* far_m, int count,
                        bool* blocked) const {
  RTCIntersectContext context = newContext(RTC_INTERSECT_CONTEXT_FLAG_COHERENT);
  alignas(32) int valid[kPacket];
  RTCRay8 rays;
  bool any = false;
  for (int i = 0; i < kPacket; ++i) {
    const int source = i < count ? i : 0;
    const bool asked = i < count && far_m[i] > 0.0F;
    any = any || asked;
    valid[i] = asked ? -1 : 0;
    setRay(rays, i, origins[source], directions[source], far_m[source]);
  }
  if (any) rtcOccluded8(valid, data_->scene, &context, &rays);
  for (int i = 0; i < count; ++i) blocked[i] = valid[i] != 0 && rays.tfar[i] < 0.0F;
}

const Surface& Snapshot::surfaceOf(const Hit& hit) const {
  const Mesh& mesh = *objects_[hit.object].mesh;
  return mesh.surfaces[mesh.triangles[hit.triangle].surface];
}

Color Snapshot::colorOf(const Hit& hit) const {
  const Surface& surface = surfaceOf(hit);
  if (surface.palette_slot < 0) return surface.color;
  return (*objects_[hit.object].palette)[static_cast<std::size_t>(surface.palette_slot)];
}

Vector3f Snapshot::shadingNormal(const Hit& hit) const {
  const Mesh& mesh = *objects_[hit.object].mesh;
  const auto& corners = mesh.triangles[hit.triangle].corners;
  const Vector3f local = (1.0F - hit.u - hit.v) * mesh.normals[corners[0]] +
                         hit.u * mesh.normals[corners[1]] + hit.v * mesh.normals[corners[2]];
  const Vector3f normal = (data_->T_map_from_objects[hit.object].linear() * local).normalized();
  return normal.dot(hit.normal) < 0.0F ? Vector3f(-normal) : normal;
}

Eigen::Vector3d Snapshot::velocityAt(const Hit& hit, const Eigen::Vector3d& point) const {
  const PlacedObject& object = objects_[hit.object];
  return object.velocity + object.angular_velocity.cross(point - object.T_map_from_object.translation());
}

}  // namespace radar_dot::simulation
