# The answering side of dse's datagrams in lockstep (docs/udp.md): the part of GDScript that Godot 3 and 4 have in common.
# Sockets are read only in take(): call it in each frame until it returns null.

enum { STARTED, STEP, ENDED }

const MAGIC_VERSION = 0x44534531
const MOST_VALUES = 8000
const START = 1
const END = 2
const LATE = 4
const BUSY = 8
const ANSWER = 16
const BUFFER = 1048576 # bytes

var is_listening = false
# Datagrams that were not used: torn, old, of other sessions, of a wrong size.
var ignored = 0

var _line = PacketPeerUDP.new()
var _asked = 0
var _answered = 0
var _session = 0
var _sequence = -1
var _told = -1
var _peer = []
var _last = null
var _over = []


# Listens at a port for *asked* values, and answers *answered* of them.
func _init(port, asked, answered, address = "127.0.0.1"):
	_asked = asked
	_answered = answered
	var fits = asked >= 0 and asked <= MOST_VALUES and answered >= 0 and answered <= MOST_VALUES
	var listen = "bind" if _line.has_method("bind") else "listen"
	is_listening = fits and _line.call(listen, port, address, BUFFER) == OK


# What happened next, or null: a dictionary with happened (STARTED: put the world to its start and answer with its state
# at time; STEP: advance from time by a step, then answer; ENDED: no answer), session, sequence, time, is_late, values.
func take():
	while _line.get_available_packet_count() > 0:
		var data = _line.get_packet()
		var packet = _read(data)
		var request = null
		if packet != null:
			request = _heard(packet, [_line.get_packet_ip(), _line.get_packet_port()])
		else:
			ignored += 1
		if request != null:
			return request
	return null


# Answers a request once, with the values at a time in s. An answer after the session has ended has no effect.
func answer(request, time, values):
	if values.size() != _answered:
		push_error("%d values are answered, not %d" % [_answered, values.size()])
		return
	if _session == 0 or request.session != _session or request.sequence != _sequence or _told == _sequence:
		return
	_told = _sequence
	_last = _packet(_session, _told, START if _told == 0 else 0, time, values)
	_send(_last, _peer)


# Ends the session from this side: the run ends regularly, and what it has is its result.
func end_session():
	if _session == 0:
		return
	for _k in range(3): # any of them may be lost
		_send(_packet(_session, int(max(_sequence, 0)), END, 0.0, _zeros()), _peer)
	_forget()


func close():
	_line.close()


func _read(data):
	if data.size() != 28 + 8 * _asked:
		return null
	var stream = StreamPeerBuffer.new()
	stream.data_array = data
	var magic = stream.get_32()
	var packet = {"session": stream.get_32(), "sequence": stream.get_32(), "flags": stream.get_32()}
	packet.time = stream.get_double()
	packet.values = []
	var is_finite_ = not (is_nan(packet.time) or is_inf(packet.time))
	for _k in range(_asked):
		var value = stream.get_double()
		is_finite_ = is_finite_ and not (is_nan(value) or is_inf(value))
		packet.values.append(value)
	var is_whole = magic == MAGIC_VERSION and stream.get_32() == packet.sequence
	var is_ours = packet.session > 0 and packet.sequence >= 0 and (packet.flags & ~(START | END | LATE)) == 0
	return packet if is_whole and is_ours and is_finite_ else null


func _heard(packet, sender):
	var number = packet.sequence
	var starts = packet.flags & (START | END) == START and number == 0 and not packet.session in _over
	if _session == 0 and starts:
		_session = packet.session
		_peer = sender
		_told = -1
		return _request(STARTED, packet)
	if _session != 0 and _session != packet.session and starts:
		_send(_packet(packet.session, number, BUSY, 0.0, _zeros()), sender)
		return null
	if _session == 0 or _session != packet.session or sender != _peer:
		ignored += 1
		return null
	if packet.flags & END != 0:
		_forget()
		return _request(ENDED, packet)
	if number == _sequence:
		if _told == _sequence: # its answer was lost
			_send(_last, _peer)
		return null
	if number == _sequence + 1 and _told == _sequence:
		return _request(STEP, packet)
	ignored += 1
	return null


func _request(happened, packet):
	if happened != ENDED:
		_sequence = packet.sequence
	return {
		"happened": happened,
		"session": packet.session,
		"sequence": packet.sequence,
		"time": packet.time,
		"is_late": packet.flags & LATE != 0,
		"values": packet.values,
	}


func _forget():
	_over.append(_session)
	if _over.size() > 8:
		_over.pop_front()
	_session = 0
	_sequence = -1
	_told = -1


func _packet(session, sequence, flags, time, values):
	var stream = StreamPeerBuffer.new()
	for number in [MAGIC_VERSION, session, sequence, flags | ANSWER]:
		stream.put_32(number)
	stream.put_double(time)
	for value in values:
		stream.put_double(value)
	stream.put_32(sequence)
	return stream.data_array


func _zeros():
	var zeros = []
	for _k in range(_answered):
		zeros.append(0.0)
	return zeros


func _send(data, to):
	_line.set_dest_address(to[0], to[1])
	_line.put_packet(data) # a lost answer is asked for again
