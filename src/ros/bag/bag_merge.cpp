#include "ros/bag/bag_merge.h"

#include <algorithm>
#include <utility>

#include "ros/bag/bag_records.h"

namespace tissue_contact {
namespace {

/// What keeping a message takes beside its bytes.
constexpr std::size_t kNodeBytes = 128;

}  // namespace

BagMerge::BagMerge(const BagReader& bag) : bag_(bag), read_(bag.chunks_.size(), false) {
  for (const Part& part : bag.parts_) queues_[part.connection].parts.push_back(&part);
  for (auto& [number, queue] : queues_) {
    queue.connection = &bag.connections_.at(number);
    std::sort(queue.parts.begin(), queue.parts.end(), [](const Part* a, const Part* b) {
      return a->first != b->first ? a->first > b->first : a->chunk > b->chunk;
    });
    insert(&queue);
  }
}

const BagMerge::Part* BagMerge::missing(Queue& queue) const {
  while (!queue.parts.empty() && read_[queue.parts.back()->chunk]) queue.parts.pop_back();
  if (queue.parts.empty()) return nullptr;
  const Part* part = queue.parts.back();
  const bool is_here = !queue.waiting.empty() && std::get<0>(queue.waiting.begin()->first) < part->first;
  return is_here ? nullptr : part;
}

ros::Time BagMerge::nextTime(Queue& queue) const {
  const Part* part = missing(queue);
  return part != nullptr ? part->first : std::get<0>(queue.waiting.begin()->first);
}

/// Of queues with one time, the one that was put in last is first: what rosbag::View does with up to 16 connections.
void BagMerge::insert(Queue* queue) {
  if (missing(*queue) == nullptr && queue->waiting.empty()) return;
  const auto later = [this](const ros::Time& time, Queue* other) { return time > nextTime(*other); };
  order_.insert(std::upper_bound(order_.begin(), order_.end(), nextTime(*queue), later), queue);
}

std::optional<BagMessage> BagMerge::next() {
  if (order_.empty()) return std::nullopt;
  Queue& queue = *order_.back();
  order_.pop_back();
  while (const Part* part = missing(queue)) readChunk(part->chunk);
  const auto first = queue.waiting.begin();
  const ros::Time recorded = std::get<0>(first->first);
  current_ = std::move(first->second);
  queue.waiting.erase(first);
  waiting_bytes_ -= current_.size() + kNodeBytes;
  insert(&queue);
  return BagMessage{*queue.connection, recorded, current_};
}

void BagMerge::readChunk(std::uint32_t number) {
  const BagReader::Chunk& chunk = bag_.chunks_[number];
  std::map<std::uint32_t, Found> wanted;
  for (std::size_t i = chunk.part; i < bag_.parts_.size() && bag_.parts_[i].chunk == number; ++i) {
    const Part& part = bag_.parts_[i];
    wanted[part.connection] = {&queues_.at(part.connection), &part, 0, ros::Time()};
  }
  try {
    decompressed_bytes_ += readMessages(chunk, wanted);
    for (const auto& [connection, found] : wanted) {
      if (found.count == found.part->count && found.first == found.part->first) continue;
      throw BagError("its messages on " + found.queue->connection->topic + " are not those that its index lists",
                     BagError::Remedy::kReindex);
    }
  } catch (const BagError& error) {
    throw BagError("chunk at byte " + std::to_string(chunk.position) + ": " + error.what(), error.remedy());
  }
  read_[number] = true;
  if (decompressed_bytes_ > bag_.limits_.free_bytes + bag_.limits_.expansion * bag_.input_.size()) {
    throw BagError("so far it has grown to " + std::to_string(decompressed_bytes_) + " bytes, decompressed, from " +
                       std::to_string(bag_.input_.size()) + ", which is more than is read",
                   BagError::Remedy::kAsSaid);
  }
}

/// To the end, where the checksums of compressed data stand, before any message is handed out. Returns the bytes read.
std::uint64_t BagMerge::readMessages(const BagReader::Chunk& chunk, std::map<std::uint32_t, Found>& wanted) {
  BagRecords records(openBytes(bag_.input_, chunk.position, chunk.stored, chunk.compression), 0, chunk.size);
  for (std::uint32_t place = 0; !records.done(); ++place) {
    const Op op = records.next();
    if (op == Op::kConnection) continue;
    if (op == Op::kZeros) throw BagError("its last message is cut off: zeros follow");
    if (op != Op::kMessage) throw BagError("it holds a record that is no message");
    const auto number = records.fields().number<std::uint32_t>("conn");
    if (bag_.messageCount(number) == 0) continue;
    const ros::Time time = bagTime(records.fields().number<std::uint64_t>("time"));
    if (time.isZero()) continue;
    const auto found = wanted.find(number);
    if (found == wanted.end()) {
      throw BagError("its index lacks " + bag_.connections_.at(number).topic, BagError::Remedy::kReindex);
    }
    keep(found->second, time, place, records.data(bag_.limits_.message_bytes));
  }
  records.finish();
  return records.position();
}

void BagMerge::keep(Found& found, ros::Time time, std::uint32_t place, std::string data) {
  if (found.count++ == 0 || time < found.first) found.first = time;
  waiting_bytes_ += data.size() + kNodeBytes;
  if (waiting_bytes_ > bag_.limits_.waiting_bytes) {
    throw BagError(
        "it is so far out of order that more than " + std::to_string(bag_.limits_.waiting_bytes) +
            " bytes of messages would have to be held; `rosbag filter old.bag new.bag True` puts it in order",
        BagError::Remedy::kAsSaid);
  }
  found.queue->waiting.emplace(Turn(time, found.part->chunk, place), std::move(data));
}

}  // namespace tissue_contact
