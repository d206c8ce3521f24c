// A bag of ROS 1 with an inertial unit in it (http://wiki.ros.org/Bags/Format/2.0): one chunk, not packed.
"use strict";

const BAR = "=".repeat(80), VECTOR = "float64 x\nfloat64 y\nfloat64 z\n";
const IMU = "Header header\ngeometry_msgs/Quaternion orientation\nfloat64[9] orientation_covariance\ngeometry_msgs/Vector3 angular_velocity\n" +
  "float64[9] angular_velocity_covariance\ngeometry_msgs/Vector3 linear_acceleration\nfloat64[9] linear_acceleration_covariance\n" +
  `${BAR}\nMSG: std_msgs/Header\nuint32 seq\ntime stamp\nstring frame_id\n${BAR}\nMSG: geometry_msgs/Quaternion\n${VECTOR}float64 w\n${BAR}\nMSG: geometry_msgs/Vector3\n${VECTOR}`;

function words(...values) {
  const bytes = Buffer.alloc(4 * values.length);
  values.forEach((value, i) => bytes.writeUInt32LE(value, 4 * i));
  return bytes;
}

function record(fields, data) {
  const head = Buffer.concat(Object.entries(fields).map(([name, value]) => {
    const text = Buffer.concat([Buffer.from(`${name}=`), Buffer.isBuffer(value) ? value : Buffer.from(value)]);
    return Buffer.concat([words(text.length), text]);
  }));
  return Buffer.concat([words(head.length), head, words(data.length), data]);
}

/** sensor_msgs/Imu at `ms`: rad/s, m/s². */
function imu(seq, ms, rate, force) {
  const floats = Buffer.alloc(8 * 37);
  floats.writeDoubleLE(1, 8 * 3);
  floats.writeDoubleLE(-1, 8 * 4);
  rate.forEach((value, i) => floats.writeDoubleLE(value, 8 * (13 + i)));
  force.forEach((value, i) => floats.writeDoubleLE(value, 8 * (25 + i)));
  return Buffer.concat([words(seq), stamp(ms), words(3), Buffer.from("imu"), floats]);
}

const stamp = ms => words(1700000000 + Math.floor(ms / 1000), ms % 1000 * 1e6);

/** Bytes of a bag of 100 Hz: samples are [rate, force], three axes each. */
function bagOf(samples) {
  const op = code => Buffer.from([code]), last = 10 * (samples.length - 1);
  const connection = record({ op: op(7), conn: words(0), topic: "/imu" },
    record({ topic: "/imu", type: "sensor_msgs/Imu", md5sum: "6a62c6daae103f4ff57a132d6f95cec2", message_definition: IMU }, Buffer.alloc(0)).subarray(4, -4));
  const parts = [connection], index = [];
  let at = connection.length;
  samples.forEach(([rate, force], i) => {
    const message = record({ op: op(2), conn: words(0), time: stamp(10 * i) }, imu(i, 10 * i, rate, force));
    index.push(stamp(10 * i), words(at));
    parts.push(message);
    at += message.length;
  });
  const chunk = record({ op: op(5), compression: "none", size: words(at) }, Buffer.concat(parts));
  const indexed = record({ op: op(4), ver: words(1), conn: words(0), count: words(samples.length) }, Buffer.concat(index));
  const magic = Buffer.from("#ROSBAG V2.0\n"), begin = magic.length + 4096;
  const header = end => {
    const made = record({ op: op(3), index_pos: words(end, 0), conn_count: words(1), chunk_count: words(1) }, Buffer.alloc(0)), blank = 4096 - made.length;
    return Buffer.concat([made.subarray(0, -4), words(blank), Buffer.alloc(blank, " ")]);
  };
  const info = record({ op: op(6), ver: words(1), chunk_pos: words(begin, 0), start_time: stamp(0), end_time: stamp(last), count: words(1) }, words(0, samples.length));
  return Buffer.concat([magic, header(begin + chunk.length + indexed.length), chunk, indexed, connection, info]);
}

module.exports = { bagOf };
