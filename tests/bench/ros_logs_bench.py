#!/usr/bin/python3
"""Speed and memory of the readers of ROS logs: ros_logs_bench.py SENSORCHAR [--gigabytes 2] [--folder DIR]

Makes an MCAP file of one IMU (uncompressed chunks of 1 MiB, CDR, as rosbag2 writes them) and a bag of an IMU
beside a camera (python3-rosbag), and reads each: MB/s of processor time, with and without the digest of the
file, and the largest memory. Files are kept for another run."""
import argparse
import os
import pathlib
import struct
import subprocess
import time
import zlib

IMU = ("std_msgs/Header header\ngeometry_msgs/Quaternion orientation\nfloat64[9] "
       "orientation_covariance\ngeometry_msgs/Vector3 angular_velocity\n"
       "float64[9] angular_velocity_covariance\ngeometry_msgs/Vector3 linear_acceleration\nfloat64[9] "
       "linear_acceleration_covariance\n" + "=" * 80 +
       "\nMSG: std_msgs/Header\nbuiltin_interfaces/Time stamp\nstring frame_id\n" + "=" * 80
       + "\nMSG: geometry_msgs/Quaternion\nfloat64 x\nfloat64 y\n"
       "float64 z\nfloat64 w\n" + "=" * 80 + "\nMSG: geometry_msgs/Vector3\nfloat64 x\nfloat64 y\nfloat64 z\n")


def text(value):
    return struct.pack("<I", len(value)) + value


def record(op, content):
    return struct.pack("<BQ", op, len(content)) + content


def make_mcap(path, size):
    """As many messages at 1 kHz as fit: the same noise again and again."""
    noise = os.urandom(1 << 16)
    with path.open("wb") as file:
        file.write(b"\x89MCAP0\r\n" + record(1, text(b"ros2") + text(b"bench")))
        head = record(3, struct.pack("<H", 1) + text(b"sensor_msgs/msg/Imu") + text(b"ros2msg")
                      + text(IMU.encode())) + record(
            4, struct.pack("<HH", 0, 1) + text(b"/imu") + text(b"cdr") + text(b""))
        i = 0
        while file.tell() < size:
            parts = [head] if i == 0 else []
            for _ in range(3000):
                t = 1700000000 * 10**9 + i * 10**6
                k = i * 12 % 60000
                rates = [v / 1e5 for v in struct.unpack_from("<3h", noise, k)]
                forces = [v / 1e4 for v in struct.unpack_from("<3h", noise, k + 6)]
                values = [0, 0, 0, 1, -1] + [0.0] * 8 + rates + [0.0] * 9 + forces + [0.0] * 9
                data = b"\0\1\0\0" + struct.pack("<iII4s37d", t // 10**9, t % 10**9, 4, b"imu\0", *values)
                parts.append(struct.pack("<BQHIQQ", 5, 22 + len(data), 0, i, t, t) + data)
                i += 1
            content = b"".join(parts)
            file.write(record(6, struct.pack("<QQQI", 0, 0, len(content), zlib.crc32(content)) + text(b"")
                              + struct.pack("<Q", len(content)) + content))
        file.write(record(15, bytes(4)) + record(2, bytes(20)) + b"\x89MCAP0\r\n")


def make_bag(path, size):
    import rosbag
    import rospy
    from sensor_msgs.msg import Image, Imu
    image, imu = Image(height=720, width=960, encoding="mono8", step=960, data=os.urandom(960 * 720)), Imu()
    with rosbag.Bag(str(path), "w") as bag:
        written = i = 0
        while written < size:
            stamp = rospy.Time(1700000000 + i // 200, i % 200 * 5000000)
            imu.header.stamp = image.header.stamp = stamp
            imu.angular_velocity.x, imu.linear_acceleration.z = (i * 7919 % 1000) / 1e5, 9.8 + (i * 104729 % 1000) / 1e4
            bag.write("/imu", imu, stamp)
            written += 400
            if i % 20 == 0:
                bag.write("/camera", image, stamp)
                written += len(image.data)
            i += 1


def run(words):
    begin = time.monotonic()
    child = subprocess.Popen(words, stdout=subprocess.DEVNULL)
    _, status, usage = os.wait4(child.pid, 0)
    after = usage.ru_utime + usage.ru_stime
    return status, time.monotonic() - begin, after, usage.ru_maxrss / 1024


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("program")
    parser.add_argument("--gigabytes", type=float, default=2)
    parser.add_argument("--folder", default="/tmp")
    arguments = parser.parse_args()
    size = int(arguments.gigabytes * 1e9)
    for name, make in (("bench.mcap", make_mcap), ("bench.bag", make_bag)):
        path = pathlib.Path(arguments.folder) / name
        if not path.exists() or path.stat().st_size < size * 0.9:
            make(path, size)
        megabytes = path.stat().st_size / 1e6
        status, wall, cpu, memory = run([arguments.program, "inspect", str(path), "--topic", "/imu"])
        print(f"{name}: {megabytes:.0f} MB in {wall:.2f} s ({megabytes / wall:.0f} MB/s), {cpu:.2f} s of processors "
              f"({megabytes / cpu:.0f} MB/s a core), "
              f"memory at most {memory:.0f} MB, exit {status}")


if __name__ == "__main__":
    main()
