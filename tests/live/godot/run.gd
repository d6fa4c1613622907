# The example at a port.
extends SceneTree


func _init():
	var node = load("res://outside.gd").new()
	node.port = int(OS.get_cmdline_args()[-1])
	get_root().add_child(node)
	print("a world at 127.0.0.1:%d" % node.port)
