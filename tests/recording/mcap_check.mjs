// node mcap_check.mjs LOG: reads a recording with MCAP's reference library, through its index and
// again front to back, and prints what it saw as JSON. Fails when the library finds anything wrong.
// Whole numbers of 64 bits are printed as strings.
import { readFile } from "node:fs/promises";

import { crc32 } from "@foxglove/crc";
import { McapIndexedReader, McapStreamReader } from "@mcap/core";
import { loadDecompressHandlers, protobufFromBinaryDescriptor } from "@mcap/support";

const bytes = new Uint8Array(await readFile(process.argv[2]));
const decompressHandlers = await loadDecompressHandlers();

const readable = {
  size: async () => BigInt(bytes.length),
  read: async (offset, size) => bytes.subarray(Number(offset), Number(offset + size)),
};
const indexed = await McapIndexedReader.Initialize({ readable, decompressHandlers });

const types = new Map();
for (const [id, schema] of indexed.schemasById) {
  types.set(id, protobufFromBinaryDescriptor(schema.data).lookupType(schema.name));
}

const messages = [];
for await (const message of indexed.readMessages({ validateCrcs: true })) {
  const type = types.get(indexed.channelsById.get(message.channelId).schemaId);
  const fields = type.toObject(type.decode(message.data), { longs: String, defaults: true });
  messages.push({
    sequence: message.sequence,
    log_time: String(message.logTime),
    publish_time: String(message.publishTime),
    fields,
  });
}

const metadata = {};
for await (const record of indexed.readMetadata()) {
  metadata[record.name] = Object.fromEntries(record.metadata);
}

const streamed = { records: {}, done: false };
const stream = new McapStreamReader({ decompressHandlers, validateCrcs: true });
stream.append(bytes);
for (let record; (record = stream.nextRecord()); ) {
  streamed.records[record.type] = (streamed.records[record.type] ?? 0) + 1;
}
streamed.done = stream.done();

// The library leaves the two CRCs of the sections to its callers.
const { footer, dataEndOffset, dataSectionCrc, statistics } = indexed;
const crcAndMagic = 4 + 8;
const crcs = {
  data: dataSectionCrc === crc32(bytes.subarray(0, Number(dataEndOffset))),
  summary:
    footer.summaryCrc ===
    crc32(bytes.subarray(Number(footer.summaryStart), bytes.length - crcAndMagic)),
};

const asText = (_, value) => (typeof value === "bigint" ? String(value) : value);
process.stdout.write(
  JSON.stringify(
    {
      header: indexed.header,
      topics: [...indexed.channelsById.values()].map((channel) => channel.topic),
      chunks: indexed.chunkIndexes.length,
      groups: indexed.summaryOffsetsByOpcode.size,
      statistics: {
        messages: statistics.messageCount,
        chunks: statistics.chunkCount,
        metadata: statistics.metadataCount,
        start: statistics.messageStartTime,
        end: statistics.messageEndTime,
      },
      crcs,
      streamed,
      metadata,
      messages,
    },
    asText,
  ),
);
