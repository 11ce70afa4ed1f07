"""ROS connections by hand, for what rospy and roscpp do not do: a message cut off in the middle, a subscriber that does
not read. Protocol: the ROS slave API over XML-RPC, TCPROS."""
import io
import socket
import struct
import threading
import xmlrpc.client
import xmlrpc.server

import rosgraph

import harness

HOST = "localhost"


def header(**fields):
    parts = b"".join(struct.pack("<I", len(part)) + part for part in
                     (("%s=%s" % item).encode() for item in fields.items()))
    return struct.pack("<I", len(parts)) + parts


def framed(message):
    """A message as it goes over the wire: its length, itself."""
    body = io.BytesIO()
    message.serialize(body)
    return struct.pack("<I", len(body.getvalue())) + body.getvalue()


def receive(connection, size):
    data = b""
    while len(data) < size:
        more = connection.recv(size - len(data))
        if not more:
            raise EOFError()
        data += more
    return data


def receive_framed(connection):
    return receive(connection, struct.unpack("<I", receive(connection, 4))[0])


class Publisher:
    """Offers a topic to the master under a name of its own. To every subscriber that connects: send(connection), from a
    thread; the connection is closed when that returns."""

    def __init__(self, name, topic, message_type, send):
        self._name, self._topic, self._type, self._send = name, topic, message_type, send
        self._listener = socket.create_server((HOST, 0))
        self._slave = xmlrpc.server.SimpleXMLRPCServer((HOST, 0), logRequests=False)
        self._slave.register_function(self._request_topic, "requestTopic")
        self._uri = "http://%s:%d/" % (HOST, self._slave.server_address[1])
        self._master = rosgraph.Master(name)
        for work in [self._slave.serve_forever, self._serve]:
            threading.Thread(target=work, daemon=True).start()
        self._master.registerPublisher(topic, message_type._type, self._uri)

    def _request_topic(self, _caller, _topic, _protocols):
        return [1, "", ["TCPROS", HOST, self._listener.getsockname()[1]]]

    def _serve(self):
        while True:
            try:
                connection = self._listener.accept()[0]
            except OSError:
                return  # closed
            with connection:
                receive_framed(connection)
                connection.sendall(header(callerid=self._name, latching=0, md5sum=self._type._md5sum,
                                          message_definition="", topic=self._topic, type=self._type._type))
                self._send(connection)

    def close(self):
        self._listener.close()
        self._master.unregisterPublisher(self._topic, self._uri)
        self._slave.shutdown()
        self._slave.server_close()


class Subscriber:
    """A connection to one publisher of a topic, from which nothing is read until next() is called."""

    def __init__(self, node, topic, message_type):
        self._type = message_type
        slave = xmlrpc.client.ServerProxy(rosgraph.Master("/tcpros").lookupNode(node))
        code, message, protocol = slave.requestTopic("/tcpros", topic, [["TCPROS"]])
        assert code == 1, message
        self._connection = socket.create_connection((HOST, protocol[2]), harness.DEADLINE_S)
        self._connection.sendall(header(callerid="/tcpros", topic=topic, type=message_type._type,
                                        md5sum=message_type._md5sum, tcp_nodelay=1))
        receive_framed(self._connection)

    def next(self):
        return self._type().deserialize(receive_framed(self._connection))

    def close(self):
        self._connection.close()
