# A node that answers a co-simulation of dse: extend it, and add the script to one node of the scene.
# It makes the requested steps one after another, whatever the frame rate.
extends Node

const DseUdp = preload("res://dse/dse_udp.gd")

# Listens on loopback at this port; set these in _init of your script. The counts are those of `dse udp layout`.
var port = 5005
var asked = 0
var answered = 0
# Communication step of the bench in s.
var step = 0.01
# Milliseconds that a frame waits for a request, and the most steps in a frame: so the picture keeps moving.
var patience = 10
var most_steps = 50

var world = null


# Put the scene to its start.
func begin():
	pass


# Advance by a step in s, with the values that came.
func advance(_values, _seconds):
	pass


# The state of the scene: the values of the answer.
func read():
	return []


# The session has ended; the scene stays as it is.
func finish():
	pass


func _enter_tree():
	world = DseUdp.new(port, asked, answered)
	if not world.is_listening:
		push_error("port %d is in use, or the numbers of values are not 0 to 8000" % port)


func _exit_tree():
	world.close()


func _process(_delta):
	var waited = 0
	var done = 0
	while done < most_steps and waited <= 10 * patience:
		var request = world.take()
		if request == null:
			waited += 1
			OS.delay_usec(100)
			continue
		waited = 0
		done += 1
		if request.happened == DseUdp.ENDED:
			finish()
			return
		var reached = request.time
		if request.happened == DseUdp.STARTED:
			begin()
		else:
			advance(request.values, step)
			reached += step
		world.answer(request, reached, read())
