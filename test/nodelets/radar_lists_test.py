#!/usr/bin/env python3
# Copyright (c) 2026, the Radar-Dot developers
# SPDX-License-Identifier: BSD-3-Clause
"""Lists of radar drivers as clouds: each type of the table on messages made from its public definition. The vehicle
drives at 10 m/s; one target stands 50 m ahead, one 20 m away, 30 degrees to the left; a third one, 8 m to the left,
moves away to that side at 4 m/s."""
import math
import pathlib
import sys
import unittest

import genpy
import genpy.dynamic
import numpy as np
from geometry_msgs.msg import AccelWithCovariance, Point, Pose, PoseWithCovariance, Twist, TwistWithCovariance, Vector3
from sensor_msgs.msg import PointCloud2, PointField
from std_msgs.msg import Float64, Header, Int32, String

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2] / "scripts"))
import radar_lists

SPEED, RCS, SNR = 10.0, 12.5, 21.0
LEFT = math.radians(30.0)
TARGETS = [(50.0, 0.0), (20.0, LEFT), (8.0, math.pi / 2)]  # range, azimuth
PLACES = [(50.0, 0.0), (20.0 * math.cos(LEFT), 10.0), (0.0, 8.0)]
DOPPLERS = [-10.0, -8.6602540, 4.0]
SECTION = "\n" + 80 * "=" + "\nMSG: "


def definition(fields, *parts):
    """Text of a definition: fields apart by semicolons; parts are types with their fields, or message classes."""
    def text(part):
        if isinstance(part, tuple):
            return part[0] + "\n" + part[1].replace(";", "\n")
        return part._type + "\n" + part._full_text
    return SECTION.join([fields.replace(";", "\n"), *map(text, parts)]) + "\n"


# Names and types of the fields as their authors published them, with the md5sums of built packages.
CLUSTER = ("uint8 id;geometry_msgs/PoseWithCovariance position;geometry_msgs/TwistWithCovariance relative_velocity;"
           "float32 rcs;int8 dynamic_property;int8 class_type;int8 prob_of_exist;int8 ambig_state;int8 invalid_state")
OBJECT = ("uint8 id;geometry_msgs/PoseWithCovariance position;geometry_msgs/TwistWithCovariance relative_velocity;"
          "geometry_msgs/AccelWithCovariance relative_acceleration;float32 length;float32 width;"
          "float32 orientation_angle;float32 rcs;int8 dynamic_property;int8 class_type;int8 meas_state;"
          "int8 prob_of_exist")
CONTI_QUALITY = ("std_msgs/Float64 cluster_distlong_rms;std_msgs/Float64 cluster_distlat_rms;"
                 "std_msgs/Float64 cluster_vrellong_rms;std_msgs/Float64 cluster_vrellat_rms;"
                 "std_msgs/String cluster_pdh0;std_msgs/String cluster_invalidstate;std_msgs/String cluster_ambigstate")
SRR_LEVELS = ["Level_%d" % i for i in range(1, 8)]
ARS548_LIST = (
    "uint16 serviceID;uint16 MethodID;uint32 data_length;uint16 clientID;uint16 sessionID;uint8 protocol_version;"
    "uint8 interface_version;uint8 message_type;uint8 return_code;uint64 CRC;uint32 Length;uint32 SQC;uint32 DataID;"
    "uint32 Timestamp_Nanoseconds;uint32 Timestamp_Seconds;uint8 Timestamp_SyncStatus;uint32 EventDataQualifier;"
    "uint8 ExtendedQualifier;uint16 Origin_InvalidFlags;float32 Origin_Xpos;float32 Origin_Xstd;float32 Origin_Ypos;"
    "float32 Origin_Ystd;float32 Origin_Zpos;float32 Origin_Zstd;float32 Origin_Roll;float32 Origin_Rollstd;"
    "float32 Origin_Pitch;float32 Origin_Pitchstd;float32 Origin_Yaw;float32 Origin_Yawstd;uint8 List_InvalidFlags;"
    "detections[] detection_array;float32 List_RadVelDomain_Min;float32 List_RadVelDomain_Max;"
    "uint32 List_NumOfDetections;float32 Aln_AzimuthCorrection;float32 Aln_ElevationCorrection;uint8 Aln_Status")
ARS548_DETECTION = (
    "std_msgs/Header header;float32 f_x;float32 f_y;float32 f_z;uint8 u_InvalidFlags;float32 f_RangeRate;"
    "float32 f_RangeRateSTD;int8 s_RCS;uint16 u_MeasurementID;uint8 u_PositivePredictiveValue;uint8 u_Classification;"
    "uint8 u_MultiTargetProbability;uint16 u_ObjectID;uint8 u_AmbiguityFlag;uint16 u_SortIndex")
ARBE_FRAMES = ";".join(f"uint8 Frame_Type_{name} = {value}" for name, value in (
    ("3d_short", 1), ("3d_mid", 2), ("3d_long", 3), ("3d_ultra_long", 13), ("4d_short", 4), ("4d_mid", 5),
    ("4d_long", 6), ("4d_ultra_long", 16)))
ARS430_PACKET = ("Header header;uint8 EventID;uint32 TimeStamp;uint32 MeasurementCounter;float32 Vambig;"
                 "float32 CenterFrequency;RadarDetection[] Detections")
DEFINITIONS = {
    "ars_40X/ClusterList": (definition(
        "std_msgs/Header header;ars_40X/Cluster[] clusters", Header, ("ars_40X/Cluster", CLUSTER), PoseWithCovariance,
        TwistWithCovariance), "7e6133dc78f74cf429a4f2e9f54c616c"),
    "ars_40X/ObjectList": (definition(
        "std_msgs/Header header;ars_40X/Object[] objects", Header, ("ars_40X/Object", OBJECT), PoseWithCovariance,
        TwistWithCovariance, AccelWithCovariance), None),
    "radar_conti/ClusterList": (definition(
        "std_msgs/Header header;std_msgs/Int32 cluster_count;Cluster[] clusters", Header, Int32, Float64, String,
        ("radar_conti/Cluster", "std_msgs/Int32 cluster_id;ClusterGeneral cluster_general;"
                                "ClusterQuality cluster_quality"),
        ("radar_conti/ClusterGeneral", "std_msgs/Float64 cluster_distlong;std_msgs/Float64 cluster_distlat;"
                                       "std_msgs/Float64 cluster_vrellong;std_msgs/Float64 cluster_vrellat;"
                                       "std_msgs/Int32 cluster_dynprop;std_msgs/Float64 cluster_rcs"),
        ("radar_conti/ClusterQuality", CONTI_QUALITY)), "f224f52f8435f121b949e6b05d35dc26"),
    "radar_conti/ObjectList": (definition(
        "std_msgs/Header header;std_msgs/Int32 object_count;Object[] objects", Header, Int32, Float64, String,
        ("radar_conti/Object", "std_msgs/Int32 obj_id;ObjectGeneral object_general"),
        ("radar_conti/ObjectGeneral", "std_msgs/Float64 obj_distlong;std_msgs/Float64 obj_distlat;"
                                      "std_msgs/Float64 obj_vrellong;std_msgs/Float64 obj_vrellat;"
                                      "std_msgs/String obj_dynprop;std_msgs/Float64 obj_rcs")), None),
    "nuscenes2bag/RadarObjects": (definition(
        "std_msgs/Header header;RadarObject[] objects", Header, Vector3, (
            "nuscenes2bag/RadarObject",
            "geometry_msgs/Vector3 pose;uint8 dyn_prop;uint16 id;float32 rcs;float32 vx;float32 vy;float32 vx_comp;"
            "float32 vy_comp;uint8 is_quality_valid;uint8 ambig_state;uint8 x_rms;uint8 y_rms;uint8 invalid_state;"
            "uint8 pdh0;uint8 vx_rms;uint8 vy_rms")), "c69401412379392af20b5a4c32b76eca"),
    "ars430_ros_publisher/RadarPacket": (definition(ARS430_PACKET, Header, (
        "ars430_ros_publisher/RadarDetection",
        "float32 AzAng;float32 RCS;float32 AzAngVar;float32 VrelRad;float32 ElAng;float32 RangeVar;float32 VrelRadVar;"
        "float32 ElAngVar;float32 SNR;float32 posX;float32 posY;float32 posZ")), None),
    "radar_driver/RadarPacket": (definition(ARS430_PACKET, Header, (
        "radar_driver/RadarDetection",
        "uint8 Pdh0;float32 AzAng0;float32 RCS0;float32 AzAngVar0;float32 Prob0;float32 AzAng1;float32 RCS1;"
        "float32 AzAngVar1;float32 Prob1;float32 VrelRad;float32 ElAng;float32 RangeVar;float32 VrelRadVar;"
        "float32 ElAngVar;float32 SNR;float32 Range;float32 posX;float32 posY;float32 posZ")), None),
    "ars548_msg/DetectionList": (definition(ARS548_LIST, ("ars548_msg/detections", ARS548_DETECTION), Header),
                                 "ceeb8d9c15bf5187a1286b3bf669567a"),
    "delphi_esr_msgs/EsrTrack": (definition(
        "std_msgs/Header header;string canmsg;uint8 id;float32 lat_rate;bool grouping_changed;bool oncoming;"
        "uint8 status;float32 angle;float32 range;bool bridge_object;bool rolling_count;float32 width;"
        "float32 range_accel;uint8 med_range_mode;float32 range_rate", Header), "dbcd2eea001ab20b27c9a37e555910ae"),
    "delphi_esr_msgs/EsrTrack before 3": (definition(
        "Header header;string canmsg;uint8 track_ID;float32 track_lat_rate;bool track_group_changed;"
        "uint8 track_status;float32 track_angle;float32 track_range;bool track_bridge_object;"
        "bool track_rolling_count;float32 track_width;float32 track_range_accel;uint8 track_med_range_mode;"
        "float32 track_range_rate", Header), "0a9beb5caea714982a56115450f110c7"),
    "delphi_mrr_msgs/MrrDetection": (definition(
        "std_msgs/Header header;uint8 detection_id;uint8 confid_azimuth;bool super_res_target;bool nd_target;"
        "bool host_veh_clutter;bool valid_level;float32 azimuth;float32 range;float32 range_rate;int8 amplitude;"
        "uint8 index_2lsb", Header), "beed6f988400c44635b6b62be6463175"),
    "delphi_srr_msgs/SrrTrack": (definition(
        "std_msgs/Header header;uint8 can_tx_detect_valid_level;uint8 CAN_TX_DETECT_VALID_LEVEL_SUSPECT_DETECTION=0;"
        + "".join(f"uint8 CAN_TX_DETECT_VALID_LEVEL_{name.upper()}={i};" for i, name in enumerate(SRR_LEVELS, 1))
        + "bool can_tx_detect_status;bool CAN_TX_DETECT_STATUS_NO_DATA=0;"
          "bool CAN_TX_DETECT_STATUS_VALID_DATA_PRESENT=1;float32 can_tx_detect_range_rate;"
          "float32 can_tx_detect_range;float32 can_tx_detect_angle;float32 can_tx_detect_amplitude", Header),
        "a689930ba3ce2066d655a7425f6fdbde"),
    "delphi_srr_msgs/SrrTrack before 3": (definition(
        "Header header;uint8 CAN_TX_DETECT_VALID_LEVEL;uint8 CAN_TX_DETECT_VALID_LEVEL_Suspect_Detection=0;"
        + "".join(f"uint8 CAN_TX_DETECT_VALID_LEVEL_{name}={i};" for i, name in enumerate(SRR_LEVELS, 1))
        + "bool CAN_TX_DETECT_STATUS;bool CAN_TX_DETECT_STATUS_No_Data=0;"
          "bool CAN_TX_DETECT_STATUS_Valid_Data_Present=1;float32 CAN_TX_DETECT_RANGE_RATE;"
          "float32 CAN_TX_DETECT_RANGE;float32 CAN_TX_DETECT_ANGLE;float32 CAN_TX_DETECT_AMPLITUDE", Header),
        "fe266d1721e555c55d5d9c747938f98b"),
    "ti_mmwave_rospkg/RadarScan": (definition(
        "Header header;uint16 point_id;float32 x;float32 y;float32 z;float32 range;float32 velocity;"
        "uint16 doppler_bin;float32 bearing;float32 intensity", Header), "7a726cbc7d2934bb55d96dada9040f86"),
    "ainstein_radar_msgs/RadarTargetArray": (definition("std_msgs/Header header;RadarTarget[] targets", Header, (
        "ainstein_radar_msgs/RadarTarget",
        "uint16 target_id;float64 snr;float64 range;float64 speed;float64 azimuth;float64 elevation")),
        "e9ff18a480c0ec265f58b88134aeb493"),
    "arbe_msgs/arbeNewPcMsg": (definition(
        "std_msgs/Header RosHeader;arbePcFrameHeader PcHeader;arbePcMetadata PcMetadata;arbePcBins Points", Header,
        ("arbe_msgs/arbePcFrameHeader", "uint64 time;uint16 frame_counter;uint8 is_4d;uint8 frame_type;"
                                        "uint16 udp_lost_packages;uint32 number_of_points;uint16 crd_count;"
                                        "arbeFrameTypes frame_types"),
        ("arbe_msgs/arbeFrameTypes", ARBE_FRAMES),
        ("arbe_msgs/arbePcMetadata", "arbePcRes PcResolution;float32 range_offset;float32 range_res_in_db;"
                                     "uint32 azimuth_fft_size;uint32 elevation_fft_size;uint32 azimuth_fft_padding;"
                                     "uint32 elevation_fft_padding"),
        ("arbe_msgs/arbePcRes", "float32 range_resolution;float32 doppler_resolution;float32 azimuth_coefficient;"
                                "float32 elevation_coefficient"),
        ("arbe_msgs/arbePcBins", "uint16[] range_bin;int16[] doppler_signed_bin;int8[] azimuth_signed_bin;"
                                 "int8[] elevation_signed_bin;int16[] phase;int16[] power")),
        "6537ae358990354b634606bcfb0fa7db"),
    "off_highway_radar_msgs/Objects": (definition(
        "std_msgs/Header header;off_highway_radar_msgs/Object[] objects", Header, Point, Twist,
        ("off_highway_radar_msgs/Object",
         "std_msgs/Header header;off_highway_radar_msgs/ObjectA a;off_highway_radar_msgs/ObjectB b"),
        ("off_highway_radar_msgs/ObjectA", "uint32 can_id;time stamp;uint8 id;geometry_msgs/Point position;"
                                           "geometry_msgs/Twist velocity;bool meas;bool valid;bool hist"),
        ("off_highway_radar_msgs/ObjectB", "uint32 can_id;time stamp;uint8 id;float64 time_since_meas;uint8 zone;"
                                           "float64 rcs;bool moving;bool near;float64 exist_probability")), None),
    "radar_pa_msgs/radar_msg": (definition("Header header;radar_msg_A[48] data_A", Header, (
        "radar_pa_msgs/radar_msg_A", "uint8 message;uint32 ID;float32 distance;float32 velocity;float32 power;"
                                     "float32 angle;uint8 is_target;uint8 counter")), None),
    "sick_scan/RadarScan": (definition(
        "Header header;RadarPreHeader radarPreHeader;sensor_msgs/PointCloud2 targets;sick_scan/RadarObject[] objects",
        Header, PointCloud2, TwistWithCovariance, Pose, Vector3, PoseWithCovariance,
        ("sick_scan/RadarPreHeader",
         "uint16 uiVersionNo;sick_scan/RadarPreHeaderDeviceBlock radarPreHeaderDeviceBlock;"
         "sick_scan/RadarPreHeaderStatusBlock radarPreHeaderStatusBlock;"
         "sick_scan/RadarPreHeaderMeasurementParam1Block radarPreHeaderMeasurementParam1Block;"
         "sick_scan/RadarPreHeaderEncoderBlock[] radarPreHeaderArrayEncoderBlock"),
        ("sick_scan/RadarPreHeaderDeviceBlock", "uint32 uiIdent;uint32 udiSerialNo;bool bDeviceError;"
                                                "bool bContaminationWarning;bool bContaminationError"),
        ("sick_scan/RadarPreHeaderStatusBlock",
         "uint32 uiTelegramCount;uint32 uiCycleCount;uint32 udiSystemCountScan;uint32 udiSystemCountTransmit;"
         "uint16 uiInputs;uint16 uiOutputs"),
        ("sick_scan/RadarPreHeaderMeasurementParam1Block", "uint32 uiCycleDuration;uint32 uiNoiseLevel"),
        ("sick_scan/RadarPreHeaderEncoderBlock", "uint32 udiEncoderPos;int16 iEncoderSpeed"),
        ("sick_scan/RadarObject",
         "int32 id;time tracking_time;time last_seen;geometry_msgs/TwistWithCovariance velocity;"
         "geometry_msgs/Pose bounding_box_center;geometry_msgs/Vector3 bounding_box_size;"
         "geometry_msgs/PoseWithCovariance object_box_center;geometry_msgs/Vector3 object_box_size;"
         "geometry_msgs/Point[] contour_points")), "db9483dce93673bbf6148baa3d967315"),
}
DEFINITIONS["sick_scan_xd/RadarScan"] = (
    DEFINITIONS["sick_scan/RadarScan"][0].replace("sick_scan/", "sick_scan_xd/"), None)
CLASSES = {}


def type_of(case):
    return case.split()[0]


def make(case, kind=None, **values):
    """A message of the case, or of a type in it; values by path, with __ for the dots."""
    if case not in CLASSES:
        CLASSES[case] = genpy.dynamic.generate_dynamic(type_of(case), DEFINITIONS[case][0])
    message = CLASSES[case][kind or type_of(case)]()
    for path, value in values.items():
        *owners, name = path.split("__")
        owner = message
        for step in owners:
            owner = getattr(owner, step)
        assert hasattr(owner, name), path
        setattr(owner, name, value)
    return message


def returns(case, kind, values):
    """One message of the kind per target; values(range, azimuth, x, y, doppler)."""
    return [make(case, kind, **values(*target, *place, doppler))
            for target, place, doppler in zip(TARGETS, PLACES, DOPPLERS)]


def listed(case, path, kind, values):
    return [make(case, **{path: returns(case, kind, values)})]


def arbe_bins(case):
    return [make(case, Points__range_bin=[102, 42, 18], Points__doppler_signed_bin=[-1000, -866, 400],
                 Points__azimuth_signed_bin=[0, -32, -64], Points__elevation_signed_bin=[0, 0, 0],
                 PcMetadata__range_offset=2.0, PcMetadata__PcResolution__range_resolution=0.5,
                 PcMetadata__PcResolution__doppler_resolution=0.01,
                 PcMetadata__PcResolution__azimuth_coefficient=1.0 / 64.0,
                 PcMetadata__PcResolution__elevation_coefficient=1.0 / 64.0)]


def sick_cloud(case):
    rows = np.array([(*place, 0.0, doppler, 30.0) for place, doppler in zip(PLACES, DOPPLERS)], np.float32)
    cloud = PointCloud2(height=1, width=3, point_step=20, row_step=60, data=rows.tobytes())
    cloud.fields = [PointField(name, 4 * i, PointField.FLOAT32, 1)
                    for i, name in enumerate(("x", "y", "z", "vrad", "amplitude"))]
    cloud.header = Header(0, genpy.Time(7), "radar")
    return [make(case, targets=cloud)]


def sideways(y):
    return 4.0 if y == 8.0 else 0.0


def right_deg(azimuth):
    return -math.degrees(azimuth)


def esr(prefix, identity):
    names = iter(range(3))
    return lambda length, azimuth, x, y, doppler: {
        prefix + "range": length, prefix + "angle": right_deg(azimuth), prefix + "range_rate": doppler,
        prefix + "status": 3, prefix + identity: next(names)}


def numbered(key, values):
    names = iter(range(3))
    return lambda *target: {key: next(names), **values(*target)}


# By case: messages of one scan, and the fields beyond x, y, z and doppler with their values.
STATES = {"rcs": RCS, "ambig_state": 3, "invalid_state": 4, "pdh0": 1}
MESSAGES = {
    "ars_40X/ClusterList": (lambda case: listed(case, "clusters", "ars_40X/Cluster", lambda r, a, x, y, d: dict(
        position__pose__position__x=x, position__pose__position__y=y, relative_velocity__twist__linear__x=-SPEED,
        relative_velocity__twist__linear__y=sideways(y), rcs=RCS, ambig_state=3, invalid_state=4,
        prob_of_exist=1)), STATES),
    "ars_40X/ObjectList": (lambda case: listed(case, "objects", "ars_40X/Object", lambda r, a, x, y, d: dict(
        position__pose__position__x=x, position__pose__position__y=y, relative_velocity__twist__linear__x=-SPEED,
        relative_velocity__twist__linear__y=sideways(y), rcs=RCS, meas_state=2)), {"rcs": RCS}),
    "radar_conti/ClusterList": (lambda case: listed(
        case, "clusters", "radar_conti/Cluster", lambda r, a, x, y, d: dict(
            cluster_general__cluster_distlong__data=x, cluster_general__cluster_distlat__data=y,
            cluster_general__cluster_vrellong__data=-SPEED,
            cluster_general__cluster_vrellat__data=sideways(y), cluster_general__cluster_rcs__data=RCS,
            cluster_quality__cluster_ambigstate__data="\x03", cluster_quality__cluster_invalidstate__data="\x04",
            cluster_quality__cluster_pdh0__data="1")), STATES),
    "radar_conti/ObjectList": (lambda case: listed(
        case, "objects", "radar_conti/Object", lambda r, a, x, y, d: dict(
            object_general__obj_distlong__data=x, object_general__obj_distlat__data=y,
            object_general__obj_vrellong__data=-SPEED,
            object_general__obj_vrellat__data=sideways(y), object_general__obj_rcs__data=RCS)), {"rcs": RCS}),
    "nuscenes2bag/RadarObjects": (lambda case: listed(
        case, "objects", "nuscenes2bag/RadarObject", lambda r, a, x, y, d: dict(
            pose__x=x, pose__y=y, vx=-SPEED, vy=sideways(y), vx_comp=99.0, rcs=RCS, ambig_state=3,
            invalid_state=4, pdh0=1)), STATES),
    "ars430_ros_publisher/RadarPacket": (lambda case: listed(
        case, "Detections", "ars430_ros_publisher/RadarDetection", lambda r, a, x, y, d: dict(
            posX=r, posY=r * math.tan(a), AzAng=-a, VrelRad=d, RCS=RCS, SNR=SNR)), {"rcs": RCS, "snr": SNR}),
    "radar_driver/RadarPacket": (lambda case: listed(
        case, "Detections", "radar_driver/RadarDetection", lambda r, a, x, y, d: dict(
            Range=r, VrelRad=d, SNR=SNR, **(
                dict(AzAng0=-a, RCS0=RCS, Prob0=0.9, AzAng1=0.5, RCS1=-3.0, Prob1=0.1) if a else
                dict(AzAng0=0.5, RCS0=-3.0, Prob0=0.2, AzAng1=-a, RCS1=RCS, Prob1=0.8)))), {"rcs": RCS, "snr": SNR}),
    "ars548_msg/DetectionList": (lambda case: listed(
        case, "detection_array", "ars548_msg/detections", lambda r, a, x, y, d: dict(
            f_x=x, f_y=y, f_RangeRate=d, s_RCS=12, header=Header(0, genpy.Time(7), "radar"))), {"rcs": 12}),
    "delphi_esr_msgs/EsrTrack": (lambda case: returns(case, None, esr("", "id")), {}),
    "delphi_esr_msgs/EsrTrack before 3": (lambda case: returns(case, None, esr("track_", "ID")), {}),
    "delphi_mrr_msgs/MrrDetection": (lambda case: returns(case, None, numbered(
        "detection_id", lambda r, a, x, y, d: dict(range=r, azimuth=-a, range_rate=d, valid_level=True))), {}),
    "delphi_srr_msgs/SrrTrack": (lambda case: returns(case, None, lambda r, a, x, y, d: dict(
        can_tx_detect_range=r, can_tx_detect_angle=right_deg(a), can_tx_detect_range_rate=d,
        can_tx_detect_amplitude=RCS, can_tx_detect_status=True)), {"rcs": RCS}),
    "delphi_srr_msgs/SrrTrack before 3": (lambda case: returns(case, None, lambda r, a, x, y, d: dict(
        CAN_TX_DETECT_RANGE=r, CAN_TX_DETECT_ANGLE=right_deg(a), CAN_TX_DETECT_RANGE_RATE=d,
        CAN_TX_DETECT_AMPLITUDE=RCS, CAN_TX_DETECT_STATUS=True)), {"rcs": RCS}),
    "ti_mmwave_rospkg/RadarScan": (lambda case: returns(case, None, numbered(
        "point_id", lambda r, a, x, y, d: dict(x=x, y=y, velocity=d))), {}),
    "ainstein_radar_msgs/RadarTargetArray": (lambda case: listed(
        case, "targets", "ainstein_radar_msgs/RadarTarget", lambda r, a, x, y, d: dict(
            range=r, azimuth=math.degrees(a), speed=d, snr=SNR)), {"snr": SNR}),
    "arbe_msgs/arbeNewPcMsg": (arbe_bins, {}),
    "off_highway_radar_msgs/Objects": (lambda case: listed(
        case, "objects", "off_highway_radar_msgs/Object", lambda r, a, x, y, d: dict(
            a__position__x=x, a__position__y=y, a__velocity__linear__x=-SPEED,
            a__velocity__linear__y=sideways(y), a__valid=True, b__rcs=RCS)),
        {"rcs": RCS}),
    "radar_pa_msgs/radar_msg": (lambda case: [make(case, data_A=returns(
        case, "radar_pa_msgs/radar_msg_A", lambda r, a, x, y, d: dict(
            distance=r, angle=a, velocity=d, power=RCS, is_target=1))
        + [make(case, "radar_pa_msgs/radar_msg_A") for _ in range(45)])], {"rcs": RCS}),
    "sick_scan/RadarScan": (sick_cloud, {}),
    "sick_scan_xd/RadarScan": (sick_cloud, {}),
}


def at(seconds):
    return genpy.Time.from_sec(seconds)


class Table(unittest.TestCase):
    def test_every_type_has_a_case(self):
        converted = {name for name, keys in radar_lists.TABLE.items() if "refused" not in keys}
        self.assertEqual(converted, {type_of(case) for case in MESSAGES})
        self.assertEqual(MESSAGES.keys(), DEFINITIONS.keys())

    def test_the_definitions_are_those_of_built_packages(self):
        for case, (_, md5sum) in DEFINITIONS.items():
            if md5sum:
                self.assertEqual(make(case)._md5sum, md5sum, case)

    def test_range_rates_are_those_of_the_drive(self):
        for case, (messages, further) in MESSAGES.items():
            with self.subTest(case):
                names, rows = radar_lists.Entry(type_of(case)).rows(messages(case))
                self.assertEqual(names, ["x", "y", "z", "doppler", *further])
                self.assertEqual(rows.dtype, np.float32)
                expected = [(*place, 0.0, doppler, *further.values()) for place, doppler in zip(PLACES, DOPPLERS)]
                np.testing.assert_allclose(rows, expected, rtol=0, atol=1e-3)

    def test_scans_come_whole_from_messages_as_they_are_sent(self):
        for case, (messages, _) in MESSAGES.items():
            with self.subTest(case):
                collector = radar_lists.Collector(radar_lists.Entry(type_of(case)))
                scans, sent = [], messages(case)
                if collector.entry.keys.get("appended"):
                    scans += collector.add(make(case), at(0.9), at(0.9))
                for i, message in enumerate(sent):
                    scans += collector.add(message, at(1.0 + 0.001 * i), at(1.0 + 0.001 * i), "radar")
                self.assertEqual(bool(scans) and scans[-1].stamp == at(1.0), not collector.entry.collects)
                scans += collector.late(at(1.0 + collector.pause))
                self.assertEqual(len(scans), 0 if collector.entry.collects else 1)
                scans += collector.late(at(1.1 + collector.pause))
                self.assertEqual([(scan.stamp, scan.frame_id, len(scan.rows)) for scan in scans],
                                 [(at(1.0), "radar", 3)])

    def test_what_is_no_measurement_is_left_out(self):
        for case, path, values in (
                ("ars_40X/ObjectList", "objects", dict(meas_state=3)),
                ("delphi_esr_msgs/EsrTrack", None, dict(status=0)), ("delphi_esr_msgs/EsrTrack", None, dict(status=4)),
                ("delphi_mrr_msgs/MrrDetection", None, dict(valid_level=False)),
                ("delphi_mrr_msgs/MrrDetection", None, dict(host_veh_clutter=True)),
                ("delphi_srr_msgs/SrrTrack", None, dict(can_tx_detect_status=False)),
                ("off_highway_radar_msgs/Objects", "objects", dict(a__valid=False))):
            with self.subTest(case):
                messages = MESSAGES[case][0](case)
                first = getattr(messages[0], path)[0] if path else messages[0]
                for name, value in values.items():
                    setattr(first.a if "__" in name else first, name.split("__")[-1], value)
                _, rows = radar_lists.Entry(case).rows(messages)
                self.assertEqual(len(rows), 2)
                np.testing.assert_allclose(rows[:, :2], PLACES[1:], atol=1e-3)

    def test_heights_are_kept(self):
        for case, returns_of, name in (
                ("nuscenes2bag/RadarObjects", lambda message: message.objects[0].pose, "z"),
                ("ars548_msg/DetectionList", lambda message: message.detection_array[0], "f_z"),
                ("ti_mmwave_rospkg/RadarScan", lambda message: message, "z")):
            messages = MESSAGES[case][0](case)
            setattr(returns_of(messages[0]), name, 1.5)
            self.assertEqual(radar_lists.Entry(case).rows(messages)[1][0, 2], 1.5, case)
        case = "sick_scan/RadarScan"
        message = sick_cloud(case)[0]
        message.targets.fields[2].name, message.targets.fields[4].name = "amplitude", "z"
        self.assertEqual(radar_lists.Entry(case).rows([message])[1][0, 2], 30.0)

    def test_elevation_shortens_the_ground_distance(self):
        case = "ainstein_radar_msgs/RadarTargetArray"
        message = make(case, targets=[make(case, "ainstein_radar_msgs/RadarTarget", range=20.0, elevation=30.0)])
        np.testing.assert_allclose(radar_lists.Entry(case).rows([message])[1][0, :3], [20 * math.cos(LEFT), 0, 10],
                                   atol=1e-5)
        message = arbe_bins("arbe_msgs/arbeNewPcMsg")[0]
        message.Points.azimuth_signed_bin, message.Points.elevation_signed_bin = [0, 0, 0], [0, 32, 0]
        np.testing.assert_allclose(radar_lists.Entry("arbe_msgs/arbeNewPcMsg").rows([message])[1][1, :3],
                                   [20 * math.cos(LEFT), 0, 10], atol=1e-5)

    def test_an_ars408_that_sends_no_quality_has_no_states(self):
        case = "radar_conti/ClusterList"
        messages = MESSAGES[case][0](case)
        for cluster in messages[0].clusters:
            for text in (cluster.cluster_quality.cluster_pdh0, cluster.cluster_quality.cluster_ambigstate,
                         cluster.cluster_quality.cluster_invalidstate):
                text.data = ""
        self.assertEqual(radar_lists.Entry(case).rows(messages)[0], ["x", "y", "z", "doppler", "rcs"])

    def test_the_header_is_found(self):
        for case, frame, seconds in (("sick_scan/RadarScan", "radar", 7), ("sick_scan_xd/RadarScan", "radar", 7),
                                     ("ars548_msg/DetectionList", "radar", 7),
                                     ("arbe_msgs/arbeNewPcMsg", "", 0)):
            header = radar_lists.Entry(case).header(MESSAGES[case][0](case)[0])
            self.assertEqual((header.frame_id, header.stamp), (frame, genpy.Time(seconds)), case)
        self.assertIsNone(radar_lists.Entry("ars548_msg/DetectionList").header(make("ars548_msg/DetectionList")))


class Scans(unittest.TestCase):
    def collect(self, case, messages):
        """messages: (seconds, values). Numbers of returns, and stamps, of the scans."""
        collector = radar_lists.Collector(radar_lists.Entry(case))
        scans = []
        for seconds, values in messages:
            scans += collector.add(make(case, **values), at(seconds), at(seconds))
        return [(len(scan.rows), round(scan.stamp.to_sec(), 6)) for scan in scans + collector.flush()]

    # Keys of what comes one message at a time: the number, and what makes it valid.
    NUMBERED = {"ti_mmwave_rospkg/RadarScan": ("point_id", {}), "delphi_esr_msgs/EsrTrack": ("id", {"status": 3}),
                "delphi_mrr_msgs/MrrDetection": ("detection_id", {"valid_level": True})}

    def test_a_scan_ends_when_the_point_or_track_starts_again(self):
        for case, (key, valid) in self.NUMBERED.items():
            ids = [0, 1, 4, 0, 2, 2, 1]  # falls, repeats, falls
            messages = [(1.0 + 0.001 * i, {key: value, **valid}) for i, value in enumerate(ids)]
            self.assertEqual(self.collect(case, messages), [(3, 1.0), (2, 1.003), (1, 1.005), (1, 1.006)], case)

    def test_a_scan_ends_with_a_pause_although_numbers_grow(self):
        for case, (key, valid) in self.NUMBERED.items():
            messages = [(seconds, {key: number, **valid}) for seconds, number in
                        ((1.0, 1), (1.01, 2), (1.041, 3), (1.042, 4))]
            self.assertEqual(self.collect(case, messages), [(2, 1.0), (2, 1.041)], case)

    def test_a_scan_of_several_packets_ends_with_its_time_stamp(self):
        for package, length in (("ars430_ros_publisher", "posX"), ("radar_driver", "Range")):
            case = package + "/RadarPacket"
            detections = returns(case, package + "/RadarDetection", lambda r, a, x, y, d: {length: r})
            messages = [(1.0, dict(TimeStamp=5, Detections=detections)), (1.001, dict(TimeStamp=5)),
                        (1.002, dict(TimeStamp=5, Detections=detections)),
                        (1.003, dict(TimeStamp=6, Detections=detections))]
            self.assertEqual(self.collect(case, messages), [(6, 1.0), (3, 1.003)], case)

    def test_lists_that_their_driver_does_not_clear_are_cut(self):
        case = "radar_conti/ClusterList"
        clusters = [make(case, "radar_conti/Cluster", cluster_id__data=i) for i in range(7)]
        messages = [(1.0 + 0.1 * i, dict(clusters=clusters[first:end]))
                    for i, (first, end) in enumerate(((0, 2), (0, 4), (0, 7), (0, 7), (4, 7)))]
        # The last list does not begin as the one before: this driver has cleared it.
        self.assertEqual(self.collect(case, messages), [(2, 1.1), (3, 1.2), (0, 1.3), (3, 1.4)])

    def test_of_lists_that_grow_with_every_frame_the_complete_one_counts(self):
        case = "radar_conti/ObjectList"
        objects = [make(case, "radar_conti/Object", obj_id__data=i) for i in (0, 0, 1, 0, 1, 2, 0, 1, 2)]
        collector, scans = radar_lists.Collector(radar_lists.Entry(case)), []
        for stamp, arrival, count in ((1.0, 1.0, 0), (1.0, 1.0, 1), (1.0, 1.0, 3), (1.0, 1.01, 6), (1.0, 1.07, 9),
                                      (1.07, 1.07, 9)):
            message = make(case, header=Header(0, at(stamp), ""), objects=objects[:count])
            scans += collector.late(at(arrival)) + collector.add(message, at(stamp), at(arrival))
        self.assertEqual([(len(scan.rows), scan.stamp) for scan in scans], [(3, at(1.0))])

    def test_the_stamp_of_a_bag_that_starts_again_ends_a_scan(self):
        messages = [(9.0, {"id": 1, "status": 3}), (1.0, {"id": 2, "status": 3})]
        self.assertEqual(self.collect("delphi_esr_msgs/EsrTrack", messages), [(1, 9.0), (1, 1.0)])


class Entries(unittest.TestCase):
    def assert_refused(self, words, message_type, changes=None, messages=None):
        with self.assertRaises(radar_lists.ListError) as refusal:
            entry = radar_lists.Entry(message_type, changes)
            entry.rows(messages)
        for word in words:
            self.assertIn(word, str(refusal.exception))

    def test_a_type_of_ones_own_is_read_by_its_entry(self):
        case = "my_radar/Targets"
        DEFINITIONS[case] = definition(
            "Header header;float32 unit;Target[] targets", Header,
            ("my_radar/Target", "float32 x;float32 y;float32 z;float32 u;float32 v;float32 w;int8 quality")), None
        self.addCleanup(DEFINITIONS.pop, case)
        target = dict(x=300.0, y=0.0, z=400.0, u=-6.0, w=8.0)  # cm; only vx and vz together tell the range rate
        message = make(case, unit=0.01, targets=[make(case, "my_radar/Target", quality=quality, **target)
                                                 for quality in (2, 9)])
        entry = {"list": "targets", "x": "x * unit", "y": "y * unit", "z": "z * unit", "vx": "u", "vy": "v", "vz": "w",
                 "valid": "(quality > 3) & (quality <= 9)"}
        names, rows = radar_lists.Entry(case, entry).rows([message])
        self.assertEqual(names, ["x", "y", "z", "doppler"])
        np.testing.assert_allclose(rows, [(3.0, 0.0, 4.0, -6.0 * 0.6 + 8.0 * 0.8)], atol=1e-5)
        self.assert_refused([case, "'quality_ > 3' (valid)", "x, y, z, u"], case, {**entry, "valid": "quality_ > 3"},
                            [message])
        self.assert_refused([case, "'target' (list)", "targets"], case, {**entry, "list": "target"}, [message])

    def test_keys_of_the_table_can_be_replaced(self):
        case = "ars_40X/ClusterList"
        _, rows = radar_lists.Entry(case, {"y": "-position.pose.position.y", "rcs": ""}).rows(MESSAGES[case][0](case))
        self.assertEqual(rows.shape[1], 7)
        self.assertAlmostEqual(rows[1, 1], -10.0, places=5)

    def test_what_is_wrong_is_named(self):
        self.assert_refused(["my_radar/Targets", "~entry", "ars_40X/ClusterList"], "my_radar/Targets")
        self.assert_refused(["ars548_msg/ObjectList", "over ground", "DetectionList"], "ars548_msg/ObjectList")
        self.assert_refused(["'dopler'", "'doppler'"], "ti_mmwave_rospkg/RadarScan", {"dopler": "velocity"})
        self.assert_refused(["lacks x and y, or range and azimuth"], "my_radar/Targets", {"x": "x", "doppler": "d"})
        self.assert_refused(["lacks doppler, or vx and vy"], "my_radar/Targets", {"x": "x", "y": "y", "vx": "vx"})
        for text in ("x +", "9 ** 9 ** 9", "x ** y", "open(x)", "[x]", "x.y()", "x if y else z", "1 < x < 2", "x and y",
                     "(lambda: x)()"):
            self.assert_refused([f"'{text}'"], "ti_mmwave_rospkg/RadarScan", {"x": text})


if __name__ == "__main__":
    unittest.main()
