// SPDX-License-Identifier: BSD-3-Clause
// check.mjs FILE.mcap FRAMES: reads a recording of write_recording with readers that lsv did not
// write, completely and field by field. Prints what it found; a failed check ends with exit code 1.
import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import { crc32 } from "@foxglove/crc";
import { parse } from "@foxglove/rosmsg";
import { MessageReader } from "@foxglove/rosmsg2-serialization";
import { McapIndexedReader, McapStreamReader } from "@mcap/core";
import { decompress } from "fzstd";

const [path, framesText] = process.argv.slice(2);
const frames = Number(framesText);
const bytes = new Uint8Array(readFileSync(path));
const decompressHandlers = { zstd: (data) => decompress(data) };

/// Every record in order, by the stream reader, which checks the CRC of each chunk.
function streamed() {
  const reader = new McapStreamReader({ decompressHandlers, validateCrcs: true });
  reader.append(bytes);
  const records = [];
  for (let record = reader.nextRecord(); record; record = reader.nextRecord()) records.push(record);
  assert(reader.done(), "the stream reader came to the end");
  return records;
}

function checkCrcs(records) {
  const dataEnd = records.find((record) => record.type === "DataEnd");
  const footer = records.find((record) => record.type === "Footer");
  const summaryStart = Number(footer.summaryStart);
  const dataEndBytes = 1 + 8 + 4;
  assert.notEqual(dataEnd.dataSectionCrc, 0);
  assert.equal(crc32(bytes.subarray(0, summaryStart - dataEndBytes)), dataEnd.dataSectionCrc);
  const magicBytes = 8;
  assert.equal(crc32(bytes.subarray(summaryStart, bytes.length - magicBytes - 4)),
    footer.summaryCrc);
}

/// Every message by the index, decoded by its own schema, by topic.
async function indexed() {
  const reader = await McapIndexedReader.Initialize({
    readable: {
      size: async () => BigInt(bytes.length),
      read: async (offset, size) => bytes.subarray(Number(offset), Number(offset + size)),
    },
    decompressHandlers,
  });
  const decoders = new Map();
  for (const channel of reader.channelsById.values()) {
    const schema = reader.schemasById.get(channel.schemaId);
    assert.equal(schema.encoding, "ros2msg");
    assert.equal(channel.messageEncoding, "cdr");
    const text = new TextDecoder().decode(schema.data);
    decoders.set(channel.id, new MessageReader(parse(text, { ros2: true })));
  }
  const topics = new Map();
  let previous = 0n;
  for await (const message of reader.readMessages()) {
    assert(message.logTime >= previous, "in the order of time");
    previous = message.logTime;
    const topic = reader.channelsById.get(message.channelId).topic;
    if (!topics.has(topic)) topics.set(topic, []);
    topics.get(topic).push({ ...message, said: decoders.get(message.channelId).readMessage(message.data) });
  }
  const metadata = new Map();
  for await (const each of reader.readMetadata()) metadata.set(each.name, each.metadata);
  const attachments = [];
  for await (const each of reader.readAttachments()) attachments.push(each);
  return { reader, topics, metadata, attachments };
}

function checkFrame(index, note, image, step) {
  const milliseconds = BigInt(index) * 1000000n;
  assert.equal(note.sequence, index);
  assert.equal(note.said.index, BigInt(index));
  assert.equal(note.said.stamp_ns, milliseconds);
  assert.equal(note.said.bit_depth, 8);
  assert.equal(note.said.camera_id, BigInt(index + 1));
  assert.equal(note.said.has_camera_ns, true);
  assert.equal(note.said.camera_ns, 500n + milliseconds);
  assert.equal(note.said.arrival_ns, 700n + milliseconds);
  assert.equal(note.said.damaged, false);
  assert.equal(note.said.missing_before, BigInt(index % 3));
  assert.equal(note.said.dropped_before, BigInt(index % 2));
  assert.equal(note.said.rejected_before, BigInt(index % 5));
  assert.equal(note.said.latency_ns, 200000n);

  assert.equal(image.said.encoding, "mono8");
  assert.deepEqual([image.said.width, image.said.height, image.said.step], [9, 5, 9]);
  assert.equal(image.said.is_bigendian, 0);
  assert.deepEqual(image.said.header.stamp, { sec: 0, nanosec: index * 1000000 });
  assert.equal(image.said.data.length, 45);
  for (let y = 0; y < 5; ++y) {
    for (let x = 0; x < 9; ++x)
      assert.equal(image.said.data[9 * y + x], (index * 31 + x * 7 + y * 3) % 256);
  }

  assert.equal(step.said.frame, BigInt(index));
  assert.equal(step.said.stamp_ns, milliseconds);
  assert.equal(step.said.dx_px, 0.1 * index);
  assert(Number.isNaN(step.said.dy_px));
  assert.equal(step.said.status, index % 4 === 3 ? "dark" : "ok");
  assert.equal(step.said.x_m, 1e-6 * index);
  assert.equal(step.said.y_m, -1e-6);
  assert.equal(step.said.keyframe, -1n);
  assert.equal(step.said.search, "none");
  assert.equal(step.said.motion, "unknown");
  assert(Number.isNaN(step.said.static_share));
}

function checkOdometry(odometry, accepted) {
  assert.equal(odometry.length, accepted.length);
  odometry.forEach(({ said }, i) => {
    assert.equal(said.header.frame_id, "lsv_odom");
    assert.equal(said.child_frame_id, "lsv_sensor");
    assert.equal(said.pose.pose.position.x, accepted[i].said.x_m);
    assert.equal(said.pose.pose.position.y, accepted[i].said.y_m);
    assert.deepEqual(said.pose.pose.orientation, { x: 0, y: 0, z: 0, w: 1 });
    assert.equal(said.pose.covariance.length, 36);
    assert.equal(said.pose.covariance[0], 0);
    assert.equal(said.twist.covariance[35], 1e6);
  });
}

const records = streamed();
checkCrcs(records);
const { reader, topics, metadata, attachments } = await indexed();
const of = (topic) => topics.get(topic) ?? [];

const streamedMessages = records.filter((record) => record.type === "Message");
const indexedCount = [...topics.values()].reduce((sum, list) => sum + list.length, 0);
assert.equal(reader.statistics.messageCount, BigInt(indexedCount));
assert.equal(streamedMessages.length, indexedCount);
for (const channel of reader.channelsById.values()) {
  const counted = reader.statistics.channelMessageCounts.get(channel.id) ?? 0n;
  assert.equal(counted, BigInt(of(channel.topic).length), channel.topic);
}
assert.equal(reader.statistics.chunkCount, reader.chunkIndexes.length);
assert(reader.chunkIndexes.length > 1, "more than one chunk");
assert.equal(reader.statistics.metadataCount, metadata.size);
assert.equal(reader.statistics.attachmentCount, attachments.length);
assert.equal(reader.header.profile, "ros2");

assert.equal(of("/camera/frame").length, frames);
assert.equal(of("/camera/image").length, frames);
assert.equal(of("/lsv/step").length, frames);
for (let i = 0; i < frames; ++i)
  checkFrame(i, of("/camera/frame")[i], of("/camera/image")[i], of("/lsv/step")[i]);
checkOdometry(of("/odom"), of("/lsv/step").filter(({ said }) => said.status === "ok"));

const [health] = of("/lsv/health");
assert.equal(health.said.state, "running");
assert.equal(health.said.missing, 2n);
assert.equal(health.said.rejected_late, 7n);
assert.equal(health.said.latency_p99_s, 0.25);
assert(Number.isNaN(health.said.frame_rate_hz));
const [event] = of("/lsv/events");
assert.equal(event.said.level, 30);
assert.equal(event.said.name, "frames_missing");
assert.equal(event.said.msg, "Two.");

assert.equal(metadata.get("lsv.config").get("config.toml"), "preset = \"precise\"\n");
assert.equal(metadata.get("lsv.calibration").get("calibration.toml"), "schema = \"x\"\n");
assert.equal(metadata.get("lsv.recording").get("source"), "made up");
assert.equal(attachments[0].name, "sensor_maps.tif");
assert.equal(attachments[0].data.length, 11);

console.log(`${path}: ${bytes.length} bytes, ${reader.chunkIndexes.length} chunks, ` +
  `${indexedCount} messages on ${topics.size} topics decoded`);
